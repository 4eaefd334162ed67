//! `softlimb fabricate`: sheets, thread paths and molds for the actuators of a scene.

use std::fmt;
use std::path::{Path, PathBuf};

use super::shared::{parts, quantity, show};
use super::{Failure, Outcome, warn};
use clap::Args;
use softlimb_files::{make_folder, write_whole};
use softlimb_limb::fabricate::{
    FabricateError, Hand, Piece, Settings, Thread, Tolerances, Winding, mold, path, plan, sheet,
};
use softlimb_scene as scene;
use softlimb_scene::Quantity;

/// Write sheets, thread paths and molds for the actuators of a scene
#[derive(Args)]
#[command(
    after_help = "Writes sheet.html and sheet.md, and for each module MODULE-thread-HAND.csv and the parts of its mold,\n                  caps, ports and connector plates as STL files in mm.\n\n\
                  Example: softlimb fabricate scenes/finger.toml --out workshop"
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

/// Thread, casting and tolerances of a workshop.
#[derive(Args)]
struct Workshop {
    /// The thread of windings without `thread` in the scene: force per strain `E A` in N, diameter in mm
    #[arg(long, value_name = "N,MM", default_value = "772,0.178", allow_hyphen_values = true)]
    thread: String,
    /// Distance of turns along the axis near the hoop, else of threads across, mm, of the same windings [default: by the stiffness of the scene]
    #[arg(long, value_name = "MM", value_parser = quantity("mm", 0.01, 1e3))]
    spacing: Option<Quantity>,
    /// Thinnest wall that can be cast, 0.1 to 50 mm
    #[arg(long, value_name = "MM", default_value = "1 mm", value_parser = quantity("mm", 0.1, 50.0))]
    wall_min: Quantity,
    /// Largest distance of chords from curves, 0.001 to 1 mm
    #[arg(long, value_name = "MM", default_value = "0.05 mm", value_parser = quantity("mm", 1e-3, 1.0))]
    chord: Quantity,
    /// Inner diameter of the hose to each actuator [default: 3 mm, less for narrow chambers]
    #[arg(long, value_name = "MM", value_parser = quantity("mm", 0.5, 20.0))]
    hose: Option<Quantity>,
    #[command(flatten)]
    tolerances: Allowed,
}

/// Tolerances of parts.
#[derive(Args)]
pub(super) struct Allowed {
    /// Tolerance of the wall, 0 to 5 mm
    #[arg(long, value_name = "MM", default_value = "0.1 mm", value_parser = quantity("mm", 0.0, 5.0))]
    pub(super) wall: Quantity,
    /// Tolerance of the fiber angle, 0 to 10 deg
    #[arg(long, value_name = "DEG", default_value = "1 deg", value_parser = quantity("deg", 0.0, 10.0))]
    angle: Quantity,
    /// Relative tolerance of the elastomer's modulus, 0 to 50 %
    #[arg(long, value_name = "%", default_value = "10 %", value_parser = quantity("%", 0.0, 50.0))]
    modulus: Quantity,
}

impl Allowed {
    pub(super) fn tolerances(&self) -> Tolerances {
        Tolerances { wall_m: self.wall.si(), angle_rad: self.angle.si(), modulus: self.modulus.si() }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [wall, angle, modulus] = [&self.wall, &self.angle, &self.modulus].map(|typed| typed.shown(typed.si()));
        write!(f, "walls +- {wall}, angles +- {angle}, moduli +- {modulus}")
    }
}

impl Workshop {
    fn settings(&self) -> Result<Settings, Failure> {
        let [stiffness_n, diameter_m] = parts("--thread", &self.thread, [("N", 1e6), ("mm", 5.0)])?;
        Ok(Settings {
            thread: Thread { stiffness_n, diameter_m },
            spacing_m: self.spacing.as_ref().map(Quantity::si),
            tolerances: self.tolerances.tolerances(),
            wall_min_m: self.wall_min.si(),
            chord_m: self.chord.si(),
            hose_m: self.hose.as_ref().map(Quantity::si),
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
        write(&folder.join("sheet.html"), &sheet::html(&sheet, &pieces, &settings))?;
        write(&folder.join("sheet.md"), &sheet::markdown(&sheet))?;
        let count = pieces.iter().map(|piece| self.files(piece).len()).sum::<usize>() + 2;
        super::note(&format!("wrote {count} files to {}", folder.display()));
        show(self.json, &sheet, || table(&pieces))?;
        let of =
            |piece: &Piece| piece.warnings.iter().map(|text| format!("{}: {text}", piece.name)).collect::<Vec<_>>();
        Ok(warn(&pieces.iter().flat_map(of).collect::<Vec<_>>()))
    }

    fn write_piece(&self, folder: &Path, piece: &Piece, settings: &Settings) -> Result<(), Failure> {
        for (part, winding) in piece.windings() {
            for hand in &winding.hands {
                let points = path::points(winding, *hand, settings.chord_m);
                write(&folder.join(path_name(piece, part, *hand)), &path::csv(&points))?;
            }
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
        let of_winding = |(part, winding): (&'static str, &'_ Winding)| {
            winding.hands.clone().into_iter().map(move |hand| (part, hand))
        };
        let paths = piece.windings().flat_map(of_winding).map(|(part, hand)| path_name(piece, part, hand));
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

fn path_name(piece: &Piece, part: &str, hand: Hand) -> String {
    let hand = match hand {
        Hand::Right => "right",
        Hand::Left => "left",
        Hand::Straight => "straight",
    };
    format!("{}-{part}-{hand}.csv", piece.name)
}

fn part_name(piece: &Piece, part: &str) -> String {
    format!("{}-{part}.stl", piece.name)
}

/// A length of the turns, mm; threads along the axis have none.
fn turned(length_m: f64) -> String {
    if length_m.is_finite() { format!("{:.3}", length_m * 1e3) } else { "-".to_owned() }
}

fn table(pieces: &[Piece]) -> String {
    let mut text =
        "module            make  angle deg  hands  starts  pitch mm    turns  turn to turn mm  thread m  elastomer g"
            .to_owned();
    for (piece, (_, winding)) in pieces.iter().flat_map(|piece| piece.windings().map(move |winding| (piece, winding))) {
        text += &format!(
            "\n{:<16}  {:>4}  {:>9.3}  {:>5}  {:>6}  {:>8}  {:>7.2}  {:>15}  {:>8.2}  {:>11.2}",
            piece.name,
            piece.copies.len(),
            winding.angle_rad.to_degrees(),
            winding.hands.len(),
            winding.starts,
            turned(winding.lead_m()),
            winding.turns(),
            turned(winding.turn_spacing_m()),
            winding.all_threads_m(),
            1e3 * piece.density_kg_per_m3 * piece.elastomer_m3(),
        );
    }
    text
}
