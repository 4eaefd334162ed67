//! `softlimb trials`: how well does a limb do what its scene asks, and how well after rehearsals?

use std::fmt::Write;
use std::num::NonZero;
use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::kept::write;
use super::{Failure, Outcome};
use softlimb_chart::{WEIGHTLESS, labelled};
use softlimb_rig::learning;
use softlimb_rig::learning::{Distances, LearningError, Score, Settings, learn};
use softlimb_scene as scene;
use softlimb_scene::{Corrections, Scene};

/// Run a scene several times on one simulated limb, by the model alone and after rehearsals under a camera
#[derive(Args)]
#[command(after_help = "Example: softlimb design scenes/open/group-a.toml --out a.toml && softlimb trials a.toml\n\n\
                  What is learned, and what the lines mean: docs/trials.md")]
pub(super) struct Trials {
    /// The scene file
    scene: PathBuf,
    /// Runs to learn from
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=200))]
    rehearsals: u32,
    /// Runs to be judged by, before and after
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=200))]
    trials: u32,
    /// Standard deviation of a coordinate in one look of the camera, mm
    #[arg(long, value_name = "MM", default_value_t = 0.2, value_parser = millimetres)]
    camera: f64,
    /// Seed of what the limb is [default: the scene's]
    #[arg(long)]
    limb: Option<u64>,
    /// Seed of what differs from run to run
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write what was learned: corrections of the setpoints, in m, rad and Pa
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

fn millimetres(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=100.0).contains(&value) => Ok(value),
        _ => Err("a number of mm from 0 to 100".into()),
    }
}

impl Trials {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let settings = Settings {
            limb: self.limb.unwrap_or(scene.seed()),
            noise: self.seed,
            iterations: self.rehearsals,
            runs: NonZero::new(self.trials).unwrap_or(NonZero::<u32>::MIN),
            camera_noise_m: 1e-3 * self.camera,
        };
        let found = learn(&scene, &settings)?;
        if let Some(file) = &self.csv {
            write(file, &csv(&scene, &found.corrections))?;
        }
        if self.json {
            super::say(&self.answer(&scene, &settings, &found).to_string())?;
        } else {
            super::say(&self.table(&scene, &settings, &found))?;
        }
        Ok(Outcome::Done)
    }

    fn answer(&self, scene: &Scene, settings: &Settings, found: &learning::Outcome) -> Value {
        let distances = |found: &Distances| json!({"rmse_m": found.rmse_m(), "max_m": found.max_m});
        let score = |score: &Score| {
            let (systematic_m, error_m) = score.systematic_m();
            let target = |target: &learning::TargetScore| {
                let errors: Vec<[f64; 3]> = target.errors_m.iter().map(|error| (*error).into()).collect();
                json!({"phase": target.phase, "errors_m": errors, "repeatability_m": target.repeatability_m()})
            };
            json!({
                "targets": score.targets.iter().map(target).collect::<Vec<_>>(),
                "at_targets": distances(&score.at_targets()),
                "systematic_m": systematic_m,
                "systematic_standard_error_m": error_m,
                "at_rest": distances(&score.at_rest),
                "whole_way": distances(&score.whole_way),
            })
        };
        json!({
            "scene": scene.name(),
            WEIGHTLESS: scene.weightless(),
            "limb": settings.limb,
            "seed": settings.noise,
            "rehearsals": settings.iterations,
            "trials": settings.runs,
            "camera_noise_m": settings.camera_noise_m,
            "by_model": score(&found.by_model),
            "learned": score(&found.corrected),
            "seen_m": found.observed_m,
            "inverse_m": found.inverse_m,
        })
    }

    /// Writing to a string cannot fail.
    fn table(&self, scene: &Scene, settings: &Settings, found: &learning::Outcome) -> String {
        let (name, limb, count) = (labelled(scene.name(), scene.weightless()), settings.limb, self.trials);
        let mut text = format!(
            "{name}: limb {limb}, {count} trials each, {} rehearsals under a camera of {} mm\n\n\
             {:34} {:>16} {:>18}\n{:34} {:>8} {:>8} {:>9} {:>8}\n",
            self.rehearsals,
            self.camera,
            "",
            "by the model",
            "after rehearsals",
            "tip error, mm",
            "RMSE",
            "max",
            "RMSE",
            "max"
        );
        let mut line = |name: &str, [before, after]: [Distances; 2]| {
            let [a, b, c, d] = [before.rmse_m(), before.max_m, after.rmse_m(), after.max_m].map(|m| 1e3 * m);
            let _ = writeln!(text, "{name:34} {a:8.3} {b:8.3} {c:9.3} {d:8.3}");
        };
        for (before, after) in found.by_model.targets.iter().zip(&found.corrected.targets) {
            line(&format!("  {}", before.phase), [before.distances(), after.distances()]);
        }
        line("all targets", [found.by_model.at_targets(), found.corrected.at_targets()]);
        line("at rest, single samples", [found.by_model.at_rest, found.corrected.at_rest]);
        line("whole way, single samples", [found.by_model.whole_way, found.corrected.whole_way]);
        let repeating = |score: &Score| {
            let (mean, error) = score.systematic_m();
            format!("{:.3} +- {:.3}", 1e3 * mean, 1e3 * error)
        };
        let scatter = |score: &Score| {
            let square: f64 = score.targets.iter().map(|target| target.repeatability_m().powi(2)).sum();
            1e3 * (square / score.targets.len().max(1) as f64).sqrt()
        };
        let [before, after] = [&found.by_model, &found.corrected];
        let _ = writeln!(text, "\nat the targets, mm");
        let _ = writeln!(text, "{:34} {:>17} {:>18}", "  what repeats", repeating(before), repeating(after));
        let _ = writeln!(text, "{:34} {:17.3} {:18.3}", "  what does not", scatter(before), scatter(after));
        if let Some(inverse_m) = found.inverse_m {
            let _ = writeln!(text, "{:34} {:17.3}", "  the device's inverse, at most", 1e3 * inverse_m);
        }
        if !found.observed_m.is_empty() {
            let seen: Vec<String> = found.observed_m.iter().map(|seen| format!("{:.2}", 1e3 * seen)).collect();
            let _ = writeln!(text, "\nseen by the camera at rest, mm: {}", seen.join(", "));
        }
        text
    }
}

/// One row per instant, one column per module.
fn csv(scene: &Scene, corrections: &Corrections) -> String {
    let names = scene.modules().iter().map(|module| format!(",{}", module.name.value)).collect::<String>();
    let mut text = format!("time_s{names}\n");
    for (time_s, row) in corrections.times_s.iter().zip(&corrections.rows) {
        let values: String = row.iter().map(|value| format!(",{value:.9}")).collect();
        let _ = writeln!(text, "{time_s:.4}{values}");
    }
    text
}

impl From<LearningError> for Failure {
    fn from(error: LearningError) -> Self {
        match error {
            LearningError::Run(error) => error.into(),
            other => Self::new(other),
        }
    }
}
