//! `softlimb payload track`: a scene under loads, Table 4 of the paper.

use std::fmt::Write;
use std::num::NonZero;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::cli::shared::{quantity, show_of, write_if};
use crate::cli::{Failure, Outcome};
use softlimb_limb::Limb;
use softlimb_rig::learning::{LearningError, Settings, Tracking, UnderLoad, observe, under_load};
use softlimb_rig::payload_estimation::Observation;
use softlimb_scene as scene;
use softlimb_scene::{Quantity, Scene};

/// Seeds of noise are far from those of parts, so that no run has noise of the seed that made its parts.
const NOISE: u64 = 1_000;

/// Run a scene with loads at the tip: tip error without correction, corrected by the model, and after learning
#[derive(Args)]
#[command(after_help = "Method: docs/guide/track-under-load.md\n\n\
                        Example: softlimb payload track scenes/loaded/carry-hanging.toml --loads 5,10,15,20")]
pub(super) struct Track {
    /// The scene file
    scene: PathBuf,
    /// Loads at the tip, 0 to 500 N
    #[arg(long, value_name = "N,N,...", required = true, value_delimiter = ',', num_args = 1, value_parser = quantity("N", 0.0, 500.0))]
    loads: Vec<Quantity>,
    /// Counted runs of each kind
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeats: u32,
    /// Iterations of learning before the runs that are counted as learned
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100))]
    iterations: u32,
    /// With one load: write the tip positions that a camera measures without and with it, for `payload estimate`
    #[arg(long, value_name = "FILE")]
    tips: Option<PathBuf>,
    /// Standard deviation of a coordinate that the camera measures, 0 to 100 mm
    #[arg(long, value_name = "MM", requires = "tips", default_value = "0.2 mm", value_parser = quantity("mm", 0.0, 100.0))]
    camera: Quantity,
    /// Seed of the limb's parts [default: the scene's]
    #[arg(long)]
    seed: Option<u64>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    repeats: u32,
    rehearsals: u32,
    loads: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    load_n: f64,
    time_s: f64,
    uncorrected: Errors,
    corrected: Errors,
    taught: Errors,
}

/// Tip errors at the ends of the phases, m.
#[derive(Serialize)]
struct Errors {
    rmse_m: f64,
    max_m: f64,
    repeatability_m: f64,
}

impl From<&Tracking> for Errors {
    fn from(tracked: &Tracking) -> Self {
        Self { rmse_m: tracked.rmse_m, max_m: tracked.max_m, repeatability_m: tracked.repeatability_m }
    }
}

impl From<&UnderLoad> for Row {
    fn from(row: &UnderLoad) -> Self {
        let [uncorrected, corrected, taught] = [&row.uncorrected, &row.compensated, &row.corrected].map(Errors::from);
        Self { load_n: row.load_n, time_s: row.time_s, uncorrected, corrected, taught }
    }
}

impl Track {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let loads_n: Vec<f64> = self.loads.iter().map(Quantity::si).collect();
        if self.tips.is_some() && loads_n.len() != 1 {
            let count = loads_n.len();
            return Err(Failure::wrong_line(format!("--tips takes one load: --loads has {count}")));
        }
        let scene = scene::load(&self.scene)?;
        scene.require_no_segments("`payload track`")?;
        Limb::new(&scene)?.require_plane_benders(&scene, "`payload track`")?;
        let settings = Settings {
            limb: self.seed.unwrap_or(scene.seed()),
            noise: NOISE,
            iterations: self.iterations,
            runs: NonZero::new(self.repeats).unwrap_or(NonZero::<u32>::MIN),
            camera_noise_m: 0.0,
        };
        let rows = loads_n.iter().map(|load| under_load(&scene, *load, &settings));
        let rows: Vec<UnderLoad> = rows.collect::<Result<_, LearningError>>()?;
        let seen = match self.tips {
            Some(_) => observe(&scene, loads_n[0], &Settings { camera_noise_m: self.camera.si(), ..settings })?,
            None => Vec::new(),
        };
        let loads = rows.iter().map(Row::from).collect();
        let printed = Printed { scene: scene.name(), repeats: self.repeats, rehearsals: self.iterations, loads };
        let limb = Limb::new(&scene)?;
        show_of(self.json, &limb, &printed, || self.table(&scene, &rows))?;
        write_if(self.tips.as_ref(), || tips(&scene, &limb, &seen))?;
        Ok(Outcome::Done)
    }

    fn table(&self, scene: &Scene, rows: &[UnderLoad]) -> String {
        let mut lines = vec![
            format!(
                "{}: tip off its goals at the ends of {} phases, {} runs of the same limb; repeatability of the last place",
                scene.name(),
                scene.phases().len(),
                self.repeats
            ),
            format!(
                "{:>6} {:>7}  {:^26}  {:^26}  {:^26}",
                "load",
                "time",
                "uncorrected",
                "corrected by the model",
                format!("after {} iterations", self.iterations)
            ),
            format!("{:>6} {:>7}  {h}  {h}  {h}", "N", "s", h = format!("{:>8} {:>8} {:>8}", "RMSE", "max", "repeat")),
            format!("{:>6} {:>7}  {h}  {h}  {h}", "", "", h = format!("{:>8} {:>8} {:>8}", "mm", "mm", "mm")),
        ];
        lines.extend(rows.iter().map(|row| {
            let parts = [&row.uncorrected, &row.compensated, &row.corrected].map(cells);
            format!("{:6.1} {:7.2}  {}", row.load_n, row.time_s, parts.join("  "))
        }));
        lines.join("\n")
    }
}

/// The table that `payload estimate` reads. Writing to a string cannot fail.
fn tips(scene: &Scene, limb: &Limb, seen: &[Observation]) -> String {
    let mut text = "phase,load,x_m,y_m,z_m".to_owned();
    limb.drives().for_each(|drive| text.extend([",", &drive.name(), "_kpa"]));
    text.push('\n');
    for Observation { phase, loaded, tip_m, pressures_pa, .. } in seen {
        let (phase, load) = (&scene.phases()[*phase].name.value, if *loaded { "unknown" } else { "none" });
        let _ = write!(text, "{phase},{load},{:.6},{:.6},{:.6}", tip_m.x, tip_m.y, tip_m.z);
        pressures_pa.iter().for_each(|pa| {
            let _ = write!(text, ",{:.3}", 1e-3 * pa);
        });
        text.push('\n');
    }
    text
}

fn cells(tracked: &Tracking) -> String {
    let [rmse, max, repeat] = [tracked.rmse_m, tracked.max_m, tracked.repeatability_m].map(|m| 1e3 * m);
    format!("{rmse:8.2} {max:8.2} {repeat:8.2}")
}
