//! `softlimb calibrate creep`: creep from the response to a step.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::super::shared::{about, read, show};
use super::super::{Failure, Outcome, warn};
use super::{CHECK_UNITS, Fitting};
use softlimb_rig::calibrate::{Body, CalibrationError, Point, Points, Step, Value, fit_creep};
use softlimb_scene as scene;
use softlimb_scene::check_creep;

/// Largest change of the pressure within a step, as a share of its largest value.
const STEADY: f64 = 0.02;

/// Fit the creep of modules to the response to a pressure step
#[derive(Args)]
#[command(after_help = "Files and method: docs/guide/calibrate.md\n\n\
                        Example: softlimb calibrate creep step.csv --scene scenes/single-bending.toml")]
pub(super) struct Creep {
    /// The step, a CSV file with module, time_s, pressure_pa and a deformation
    #[arg(value_name = "FILE")]
    step: PathBuf,
    /// The scene that describes the actuators
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,
    #[command(flatten)]
    fitting: Fitting,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    creep: Vec<Answer>,
    scene_changes: &'static [String],
    warnings: &'a [String],
}

#[derive(Serialize)]
struct Answer {
    module: String,
    quantity: &'static str,
    estimates: Vec<Estimate>,
    modelled: Vec<f64>,
}

#[derive(Serialize)]
struct Estimate {
    name: String,
    value: f64,
    interval: [f64; 2],
}

impl Creep {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let about = about(&self.step);
        scene.require_no_segments("`calibrate`")?;
        let names: Vec<&str> = scene.modules().iter().map(|module| module.name.as_str()).collect();
        let points = Points::read(&read(&self.step)?, &names).map_err(|error| about(&error))?;
        if points.points.iter().any(|point| point.specimen.is_some()) {
            return Err(about(&"creep takes one specimen: give a table without the column specimen"));
        }
        if !points.timed {
            return Err(about(&"creep needs a column time_s: the time since the pressure was raised"));
        }
        let (mut table, mut answers, mut warnings) = (String::new(), Vec::new(), Vec::new());
        for module in scene.modules() {
            let of: Vec<&Point> = points.points.iter().filter(|point| point.name == *module.name).collect();
            let Some(first) = of.first() else { continue };
            if let Some(other) = of.iter().find(|point| point.quantity != first.quantity) {
                return Err(about(&format!("line {}: one deformation for each module", other.line)));
            }
            let most_pa = of.iter().map(|point| point.reading_pa).fold(f64::NEG_INFINITY, f64::max);
            if let Some(low) = of.iter().find(|point| point.reading_pa < (1.0 - STEADY) * most_pa) {
                let (line, kpa) = (low.line, most_pa * 1e-3);
                return Err(about(&format!("line {line}: the pressure of a step stands still, here at {kpa:.2} kPa")));
            }
            let rest = Body::new(module.name.as_str(), module.actuator()).at_rest(first.quantity);
            let largest = of.iter().map(|point| (point.value - rest).abs()).fold(0.0, f64::max);
            let step = Step {
                rest,
                points: of.iter().map(|point| [point.time_s.unwrap_or(0.0), point.value]).collect(),
                accuracy: (self.fitting.accuracy.si() * largest).max(f64::MIN_POSITIVE),
            };
            let fit = fit_creep(&step, &self.fitting.settings()).map_err(|error| {
                let from = match error {
                    CalibrationError::NotReproduced { point, .. } => format!(". That point is line {}", of[point].line),
                    _ => String::new(),
                };
                about(&format!("{}: {error}{from}", *module.name))
            })?;
            let [_, share, time] = &fit.values[..] else { continue };
            let refused = check_creep(share.value, time.value).err();
            warnings.extend(refused.map(|error| format!("{}: {error}: {CHECK_UNITS}", *module.name)));
            let _ = writeln!(
                table,
                "{}: creep_share = \"{:.3} %\" ({:.3} to {:.3}), creep_time = \"{:.4} s\" ({:.4} to {:.4})",
                *module.name,
                100.0 * share.value,
                100.0 * share.interval[0],
                100.0 * share.interval[1],
                time.value,
                time.interval[0],
                time.interval[1]
            );
            let estimate =
                |value: &Value| Estimate { name: value.name.to_string(), value: value.value, interval: value.interval };
            answers.push(Answer {
                module: module.name.to_string(),
                quantity: first.quantity.name(),
                estimates: fit.values.iter().map(estimate).collect(),
                modelled: fit.modelled,
            });
        }
        show(self.fitting.json, &Printed { creep: answers, scene_changes: &[], warnings: &warnings }, || table)?;
        Ok(warn(&warnings))
    }
}
