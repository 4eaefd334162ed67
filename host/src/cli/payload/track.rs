//! A scene under loads: Table 4 of the paper.

use std::fmt::Write;
use std::num::NonZero;
use std::path::Path;

use serde_json::json;

use super::Payload;
use crate::cli::kept::write;
use crate::cli::{Failure, Outcome, say};
use softlimb_rig::learning::{LearningError, Settings, Tracking, UnderLoad, observe, under_load};
use softlimb_rig::payload_estimation::Observation;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Seeds of noise are far from those of parts, so that no run has noise of the seed that made its parts.
const NOISE: u64 = 1_000;

pub(super) fn run(command: &Payload, file: &Path, loads_n: &[f64]) -> Result<Outcome, Failure> {
    if let Some(load) = loads_n.iter().find(|load| !(0.0..=500.0).contains(*load)) {
        return Err(Failure::new(format!("--track: {load} N is not within 0 to 500 N")));
    }
    if command.tips.is_some() && loads_n.len() != 1 {
        let count = loads_n.len();
        return Err(Failure::wrong_line(format!("--tips takes one load: --track has {count}")));
    }
    if !(0.0..=100.0).contains(&command.camera) {
        return Err(Failure::wrong_line(format!("--camera = {} is not allowed: 0 to 100 mm", command.camera)));
    }
    let scene = scene::load(file)?;
    let settings = Settings {
        limb: command.seed.unwrap_or(scene.seed()),
        noise: NOISE,
        iterations: command.rehearsals,
        runs: NonZero::new(command.repeats).unwrap_or(NonZero::<u32>::MIN),
        camera_noise_m: 0.0,
    };
    let rows = loads_n.iter().map(|load| under_load(&scene, *load, &settings));
    let rows: Vec<UnderLoad> = rows.collect::<Result<_, LearningError>>()?;
    let seen = match (&command.tips, loads_n) {
        (Some(file), [load_n]) => {
            let settings = Settings { camera_noise_m: 1e-3 * command.camera, ..settings };
            Some((file, tips(&scene, &observe(&scene, *load_n, &settings)?)))
        }
        _ => None,
    };
    if command.json {
        let rows: Vec<_> = rows
            .iter()
            .map(|row| {
                json!({
                    "load_n": row.load_n,
                    "time_s": row.time_s,
                    "uncorrected": json_of(&row.uncorrected),
                    "corrected": json_of(&row.compensated),
                    "taught": json_of(&row.corrected),
                })
            })
            .collect();
        say(&json!({"scene": scene.name(), "repeats": command.repeats, "rehearsals": command.rehearsals, "loads": rows}).to_string())?;
        return seen.map_or(Ok(Outcome::Done), |(file, text)| write(file, &text).map(|()| Outcome::Done));
    }
    let mut lines = vec![
        format!(
            "{}: tip off its goals at the ends of {} phases, {} runs of the same limb; repeatability of the last place",
            scene.name(),
            scene.phases().len(),
            command.repeats
        ),
        format!(
            "{:>6} {:>7}  {:^26}  {:^26}  {:^26}",
            "load",
            "time",
            "uncorrected",
            "corrected by the model",
            format!("after {} rehearsals", command.rehearsals)
        ),
        format!("{:>6} {:>7}  {h}  {h}  {h}", "N", "s", h = format!("{:>8} {:>8} {:>8}", "RMSE", "max", "repeat")),
        format!("{:>6} {:>7}  {h}  {h}  {h}", "", "", h = format!("{:>8} {:>8} {:>8}", "mm", "mm", "mm")),
    ];
    lines.extend(rows.iter().map(|row| {
        let parts = [&row.uncorrected, &row.compensated, &row.corrected].map(cells);
        format!("{:6.1} {:7.2}  {}", row.load_n, row.time_s, parts.join("  "))
    }));
    say(&lines.join("\n"))?;
    seen.map_or(Ok(Outcome::Done), |(file, text)| write(file, &text).map(|()| Outcome::Done))
}

/// The table that `--estimate` reads. Writing to a string cannot fail.
fn tips(scene: &Scene, seen: &[Observation]) -> String {
    let mut text = "phase,load,x_m,y_m,z_m".to_owned();
    scene.modules().iter().for_each(|module| text.extend([",", &module.name, "_kpa"]));
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

fn cells(tracking: &Tracking) -> String {
    let [rmse, max, repeat] = [tracking.rmse_m, tracking.max_m, tracking.repeatability_m].map(|m| 1e3 * m);
    format!("{rmse:8.2} {max:8.2} {repeat:8.2}")
}

fn json_of(tracking: &Tracking) -> serde_json::Value {
    json!({"rmse_m": tracking.rmse_m, "max_m": tracking.max_m, "repeatability_m": tracking.repeatability_m})
}
