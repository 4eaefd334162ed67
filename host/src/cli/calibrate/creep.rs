//! Creep from the response to a step.

use std::fmt::Write;
use std::path::Path;

use serde_json::json;

use super::super::Failure;
use super::super::kept::read;
use super::limb::loaded;
use super::{Calibrate, Said, about};
use softlimb_rig::calibrate::{Body, Point, Points, Step, fit_creep};

/// What the pressure of a step may move by, as a share of its largest.
const STEADY: f64 = 0.02;

impl Calibrate {
    pub(super) fn creep(&self, file: &Path) -> Result<Said, Failure> {
        if self.svg.is_some() || self.write.is_some() {
            return Err(Failure::wrong_line("--creep prints its values: no --svg and no --write"));
        }
        let scene = loaded(self.scene.as_deref())?;
        let names: Vec<&str> = scene.modules().iter().map(|module| module.name.as_str()).collect();
        let points = Points::read(&read(file)?, &names).map_err(|error| about(file)(&error))?;
        if !points.timed {
            return Err(about(file)(&"--creep needs a column time_s: the time since the pressure was raised"));
        }
        let (mut table, mut answers) = (String::new(), Vec::new());
        for module in scene.modules() {
            let of: Vec<&Point> = points.points.iter().filter(|point| point.name == *module.name).collect();
            let Some(first) = of.first() else { continue };
            if let Some(other) = of.iter().find(|point| point.quantity != first.quantity) {
                return Err(about(file)(&format!("line {}: one deformation for each module, for --creep", other.line)));
            }
            let most_pa = of.iter().map(|point| point.reading_pa).fold(f64::NEG_INFINITY, f64::max);
            if let Some(low) = of.iter().find(|point| point.reading_pa < (1.0 - STEADY) * most_pa) {
                let (line, kpa) = (low.line, most_pa * 1e-3);
                return Err(about(file)(&format!(
                    "line {line}: the pressure of a step stands still, here at {kpa:.2} kPa"
                )));
            }
            let rest = Body::new(module.name.as_str(), module.actuator()).at_rest(first.quantity);
            let largest = of.iter().map(|point| (point.value - rest).abs()).fold(0.0, f64::max);
            let step = Step {
                rest,
                points: of.iter().map(|point| [point.time_s.unwrap_or(0.0), point.value]).collect(),
                accuracy: (self.accuracy * largest).max(f64::MIN_POSITIVE),
            };
            let fit = fit_creep(&step, &self.settings())
                .map_err(|error| about(file)(&format!("{}: {error}", *module.name)))?;
            let [_, share, time] = &fit.values[..] else { continue };
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
            let value = |value: &softlimb_rig::calibrate::Value| json!({"name": value.name, "value": value.value, "interval": value.interval});
            answers.push(json!({
                "module": *module.name,
                "quantity": first.quantity,
                "estimates": fit.values.iter().map(value).collect::<Vec<_>>(),
                "modelled": fit.modelled,
            }));
        }
        Ok(Said { table, json: json!({ "creep": answers }), svg: String::new(), scene: None, warnings: Vec::new() })
    }
}
