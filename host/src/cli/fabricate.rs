//! `softlimb fabricate`: what a workshop needs to make the actuators of a scene.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::{Failure, Outcome};
use softlimb_files::{make_folder, write_whole};
use softlimb_limb::fabricate::{FabricateError, Hand, Piece, Settings, Thread, Tolerances, mold, path, plan, sheet};
use softlimb_scene as scene;

/// Sheets, paths of the thread and molds for the actuators of a scene
#[derive(Args)]
#[command(
    after_help = "Writes sheet.html and sheet.md, and for each module MODULE-thread-HAND.csv and the parts of its mold as STL files in mm.\n\
                  Example: softlimb fabricate scenes/pick-and-place-a.toml --out workshop"
)]
pub(super) struct Fabricate {
    /// The scene file
    scene: PathBuf,
    /// Folder for the files [default: out/<scene>/workshop]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    workshop: Workshop,
    /// Print what was planned as JSON
    #[arg(long)]
    json: bool,
    /// No STL files
    #[arg(long)]
    no_mold: bool,
}

/// What the workshop works with.
#[derive(Args)]
struct Workshop {
    /// The thread: force per strain `E A` in N, diameter in mm
    #[arg(long, value_name = "N,MM", value_delimiter = ',', num_args = 1, default_value = "772,0.178")]
    thread: Vec<f64>,
    /// Distance of turns along the axis near the hoop, else of threads across, mm [default: what the scene's stiffness asks for]
    #[arg(long, value_name = "MM")]
    spacing: Option<f64>,
    /// Thinnest wall that can be cast, mm
    #[arg(long, value_name = "MM", default_value_t = 1.0)]
    wall_min: f64,
    /// Largest distance of chords from curves, mm
    #[arg(long, value_name = "MM", default_value_t = 0.05)]
    chord: f64,
    #[command(flatten)]
    tolerances: Allowed,
}

/// How far parts may be off.
#[derive(Args)]
pub(super) struct Allowed {
    /// Tolerance of the wall, mm
    #[arg(long, value_name = "MM", default_value_t = 0.1)]
    wall: f64,
    /// Tolerance of the fiber angle, deg
    #[arg(long, value_name = "DEG", default_value_t = 1.0)]
    angle: f64,
    /// Tolerance of the elastomer's modulus, %
    #[arg(long, value_name = "%", default_value_t = 10.0)]
    modulus: f64,
}

impl Allowed {
    pub(super) fn tolerances(&self) -> Tolerances {
        Tolerances { wall_m: self.wall * 1e-3, angle_rad: self.angle.to_radians(), modulus: self.modulus * 1e-2 }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "walls +- {} mm, angles +- {} deg, moduli +- {} %", self.wall, self.angle, self.modulus)
    }
}

impl Workshop {
    fn settings(&self) -> Result<Settings, Failure> {
        let [stiffness_n, diameter] = self.thread[..] else {
            let count = self.thread.len();
            return Err(Failure::wrong_line(format!(
                "--thread has {count} values: two are wanted, E A in N and diameter in mm"
            )));
        };
        Ok(Settings {
            thread: Thread { stiffness_n, diameter_m: diameter * 1e-3 },
            spacing_m: self.spacing.map(|mm| mm * 1e-3),
            tolerances: self.tolerances.tolerances(),
            wall_min_m: self.wall_min * 1e-3,
            chord_m: self.chord * 1e-3,
        })
    }
}

impl From<FabricateError> for Failure {
    fn from(error: FabricateError) -> Self {
        match error {
            FabricateError::Scene(error) => error.into(),
            FabricateError::Invalid(error) => Self::wrong_line(error),
        }
    }
}

impl Fabricate {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let settings = self.workshop.settings()?;
        let pieces = plan(&scene, &settings)?;
        let default = || Path::new("out").join(scene.name()).join("workshop");
        let folder = self.out.clone().unwrap_or_else(default);
        make_folder(&folder).map_err(Failure::new)?;
        for piece in &pieces {
            self.write_piece(&folder, piece, &settings)?;
        }
        let sheet = sheet::sheet(scene.name(), &pieces, &settings, |piece| self.files(piece));
        write(&folder.join("sheet.html"), &sheet::html(&sheet))?;
        write(&folder.join("sheet.md"), &sheet::markdown(&sheet))?;
        let count = pieces.iter().map(|piece| self.files(piece).len()).sum::<usize>() + 2;
        super::note(&format!("wrote {count} files to {}", folder.display()));
        let text = if self.json { json!(sheet).to_string() } else { table(&pieces) };
        super::say(&text)?;
        let warnings = pieces.iter().flat_map(|piece| piece.warnings.iter().map(move |text| (piece, text)));
        let count = warnings.map(|(piece, text)| super::note(&format!("warning: {}: {text}", piece.name))).count();
        Ok(if count == 0 { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn write_piece(&self, folder: &Path, piece: &Piece, settings: &Settings) -> Result<(), Failure> {
        for hand in &piece.winding.hands {
            let points = path::points(&piece.winding, *hand, settings.chord_m);
            write(&folder.join(path_name(piece, *hand)), &path::csv(&points))?;
        }
        if self.no_mold {
            return Ok(());
        }
        for part in mold::parts(piece, settings).map_err(Failure::wrong_line)? {
            write(&folder.join(part_name(piece, part.name)), &part.mesh.stl())?;
        }
        Ok(())
    }

    /// Names of the files of a piece, as they are written.
    fn files(&self, piece: &Piece) -> Vec<String> {
        let paths = piece.winding.hands.iter().map(|hand| path_name(piece, *hand));
        let parts = mold::names(piece).into_iter().filter(|_| !self.no_mold).map(|(name, count)| {
            let file = part_name(piece, name);
            if count == 1 { file } else { format!("{file} (print {count})") }
        });
        paths.chain(parts).collect()
    }
}

fn write(file: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), Failure> {
    write_whole(file, content).map_err(Failure::new)
}

fn path_name(piece: &Piece, hand: Hand) -> String {
    let hand = match hand {
        Hand::Right => "right",
        Hand::Left => "left",
        Hand::Straight => "straight",
    };
    format!("{}-thread-{hand}.csv", piece.name)
}

fn part_name(piece: &Piece, part: &str) -> String {
    format!("{}-{part}.stl", piece.name)
}

fn table(pieces: &[Piece]) -> String {
    let mut text =
        "module            make  angle deg  hands  starts  pitch mm    turns  turn to turn mm  thread m  elastomer g"
            .to_owned();
    for piece in pieces {
        let winding = &piece.winding;
        text += &format!(
            "\n{:<16}  {:>4}  {:>9.3}  {:>5}  {:>6}  {:>8.3}  {:>7.2}  {:>15.3}  {:>8.2}  {:>11.2}",
            piece.name,
            piece.copies.len(),
            winding.angle_rad.to_degrees(),
            winding.hands.len(),
            winding.starts,
            winding.lead_m() * 1e3,
            winding.turns(),
            winding.turn_spacing_m() * 1e3,
            f64::from(winding.threads()) * winding.thread_m(),
            1e3 * piece.density_kg_per_m3 * piece.elastomer_m3(),
        );
    }
    text
}
