//! `softlimb learn`: iterative learning control on a perturbed limb.

use std::fmt::Write;
use std::num::NonZero;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::shared::{corrections_csv, quantity, show_of, write_if};
use super::{Failure, Outcome};
use softlimb_chart::labelled;
use softlimb_limb::Limb;
use softlimb_rig::learning;
use softlimb_rig::learning::{Distances, LearningError, Score, Settings, learn, transferred};
use softlimb_scene as scene;
use softlimb_scene::{Quantity, Scene};

/// Run iterative learning control on a perturbed limb, with tip measurements from a simulated camera
#[derive(Args)]
#[command(after_help = "Method, and meaning of the lines: docs/explanation/learning.md\n\nExamples:\n  \
                  softlimb design limb scenes/open/group-a.toml --out a.toml\n  softlimb learn a.toml --csv learned.csv")]
pub(super) struct Learn {
    /// The scene file
    scene: PathBuf,
    /// Iterations of learning
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=200))]
    iterations: u32,
    /// Runs that measure the tip error, before and after learning
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=200))]
    trials: u32,
    /// Standard deviation of a coordinate in one observation of the camera, 0 to 100 mm [default: that of the scene's `[camera]`, else 0.2 mm]
    #[arg(long, value_name = "MM", value_parser = quantity("mm", 0.0, 100.0))]
    camera: Option<Quantity>,
    /// Seed of the perturbed limb [default: the scene's]
    #[arg(long)]
    limb: Option<u64>,
    /// Seed of the noise of every run
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the learned corrections of the setpoints, in m, rad and Pa
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Evaluate the corrections in another scene of the same limb, whose phases have the same names; repeatable
    #[arg(long = "test", value_name = "SCENE")]
    tests: Vec<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl Learn {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let stated_m = scene.camera().map_or(0.2e-3, |camera| camera.noise_m);
        let settings = Settings {
            limb: self.limb.unwrap_or(scene.seed()),
            noise: self.seed,
            iterations: self.iterations,
            runs: NonZero::new(self.trials).unwrap_or(NonZero::<u32>::MIN),
            camera_noise_m: self.camera.as_ref().map_or(stated_m, Quantity::si),
        };
        let others = self.tests.iter().map(scene::load).collect::<Result<Vec<_>, _>>()?;
        let found = learn(&scene, &settings)?;
        write_if(self.csv.as_ref(), || corrections_csv(&scene, &found.corrections))?;
        let test = |other: &Scene| {
            let [by_model, learned] = transferred(other, (&scene, &found.corrections), &settings)?;
            Ok(Tested {
                scene: other.name().to_owned(),
                by_model: by_model.at_targets(),
                learned: learned.at_targets(),
            })
        };
        let tests = others.iter().map(test).collect::<Result<Vec<_>, LearningError>>()?;
        show_of(self.json, &Limb::new(&scene)?, &Printed::new(&scene, &settings, &found, &tests), || {
            self.table(&scene, &settings, &found, &tests)
        })?;
        Ok(Outcome::Done)
    }

    /// Writing to a string cannot fail.
    fn table(&self, scene: &Scene, settings: &Settings, found: &learning::Outcome, tests: &[Tested]) -> String {
        let (name, limb, count) = (labelled(scene.name(), scene.weightless()), settings.limb, self.trials);
        let mut text = format!(
            "{name}: limb {limb}, {count} trials each, {} iterations with a camera of {} mm\n\n\
             {:34} {:>16} {:>18}\n{:34} {:>8} {:>8} {:>9} {:>8}\n",
            self.iterations,
            (1e9 * settings.camera_noise_m).round() / 1e6,
            "",
            "by the model",
            "after learning",
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
        for test in tests {
            line(&format!("tested in {}", test.scene), [test.by_model, test.learned]);
        }
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

/// Errors at the targets of another scene, before learning and with what was learned.
struct Tested {
    scene: String,
    by_model: Distances,
    learned: Distances,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    weightless: bool,
    limb: u64,
    seed: u64,
    rehearsals: u32,
    trials: NonZero<u32>,
    camera_noise_m: f64,
    by_model: PrintedScore<'a>,
    learned: PrintedScore<'a>,
    seen_m: &'a [f64],
    inverse_m: Option<f64>,
    tests: Vec<PrintedTest<'a>>,
}

#[derive(Serialize)]
struct PrintedTest<'a> {
    scene: &'a str,
    by_model: PrintedDistances,
    learned: PrintedDistances,
}

#[derive(Serialize)]
struct PrintedScore<'a> {
    targets: Vec<PrintedTarget<'a>>,
    at_targets: PrintedDistances,
    systematic_m: f64,
    systematic_standard_error_m: f64,
    at_rest: PrintedDistances,
    whole_way: PrintedDistances,
}

#[derive(Serialize)]
struct PrintedTarget<'a> {
    phase: &'a str,
    errors_m: Vec<[f64; 3]>,
    repeatability_m: f64,
}

#[derive(Serialize)]
struct PrintedDistances {
    rmse_m: f64,
    max_m: f64,
}

impl<'a> Printed<'a> {
    fn new(scene: &'a Scene, settings: &Settings, found: &'a learning::Outcome, tests: &'a [Tested]) -> Self {
        let printed = |test: &'a Tested| PrintedTest {
            scene: &test.scene,
            by_model: test.by_model.into(),
            learned: test.learned.into(),
        };
        Self {
            scene: scene.name(),
            weightless: scene.weightless(),
            limb: settings.limb,
            seed: settings.noise,
            rehearsals: settings.iterations,
            trials: settings.runs,
            camera_noise_m: settings.camera_noise_m,
            by_model: (&found.by_model).into(),
            learned: (&found.corrected).into(),
            seen_m: &found.observed_m,
            inverse_m: found.inverse_m,
            tests: tests.iter().map(printed).collect(),
        }
    }
}

impl<'a> From<&'a Score> for PrintedScore<'a> {
    fn from(score: &'a Score) -> Self {
        let (systematic_m, systematic_standard_error_m) = score.systematic_m();
        let targets = score.targets.iter().map(|target| PrintedTarget {
            phase: &target.phase,
            errors_m: target.errors_m.iter().map(|error| (*error).into()).collect(),
            repeatability_m: target.repeatability_m(),
        });
        Self {
            targets: targets.collect(),
            at_targets: score.at_targets().into(),
            systematic_m,
            systematic_standard_error_m,
            at_rest: score.at_rest.into(),
            whole_way: score.whole_way.into(),
        }
    }
}

impl From<Distances> for PrintedDistances {
    fn from(found: Distances) -> Self {
        Self { rmse_m: found.rmse_m(), max_m: found.max_m }
    }
}

impl From<LearningError> for Failure {
    fn from(error: LearningError) -> Self {
        match error {
            LearningError::Run(error) => error.into(),
            other => Self::new(other),
        }
    }
}
