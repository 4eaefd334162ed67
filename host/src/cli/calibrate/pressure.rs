//! `softlimb calibrate pressure` and `calibrate run`: actuators from pressures and deformations, of a table or a log.

use fra_model::StateQuantity;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::super::shared::{about, read};
use super::super::{Failure, Outcome};
use super::{Files, Fitted, Fitting, Per, Unknowns};
use softlimb_limb::Limb;
use softlimb_rig::calibrate::{Body, Fit, Observation, Points, Property, Unknown, fit, holds, picture};
use softlimb_rig::record;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Fit actuators to a table of pressures and deformations
#[derive(Args)]
#[command(after_help = "Files and method: docs/guide/calibrate.md\n\n\
    Example: softlimb calibrate pressure finger.csv --scene scenes/single-bending.toml --fit shear_modulus,pressure_offset")]
pub(super) struct Pressure {
    /// The table, a CSV file with module, pressure_pa and axial_stretch, outer_radius_m, bend_angle_rad or twist_rad
    #[arg(value_name = "FILE")]
    data: PathBuf,
    /// The scene that describes the actuators
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,
    #[command(flatten)]
    unknowns: Unknowns,
    #[command(flatten)]
    fitting: Fitting,
    #[command(flatten)]
    files: Files,
}

/// Fit actuators to the ends of the holds of a recorded run
#[derive(Args)]
#[command(after_help = "Files and method: docs/guide/calibrate.md\n\n\
    Example: softlimb calibrate run run.mcap --fit shear_modulus --per module --write fitted.toml")]
pub(super) struct Run {
    /// The log of the run (MCAP)
    log: PathBuf,
    /// The scene that describes the actuators [default: the one in the log]
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    unknowns: Unknowns,
    #[command(flatten)]
    fitting: Fitting,
    #[command(flatten)]
    files: Files,
}

/// A measurement before its accuracy is known: module, reading, quantity, value, and where it is from.
struct Seen {
    module: usize,
    reading_pa: f64,
    quantity: StateQuantity,
    value: f64,
    from: String,
}

impl Pressure {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, about) = (scene::load(&self.scene)?, about(&self.data));
        let names: Vec<&str> = scene.modules().iter().map(|module| module.name.as_str()).collect();
        let points = Points::read(&read(&self.data)?, &names).map_err(|error| about(&error))?;
        if points.timed {
            let text = "a column time_s makes it the response to a step: use `softlimb calibrate creep`, or leave the column \
                        out of equilibria";
            return Err(about(&text));
        }
        let seen = points.points.into_iter().map(|point| Seen {
            module: names.iter().position(|name| *name == point.name).unwrap_or(0),
            reading_pa: point.reading_pa,
            quantity: point.quantity,
            value: point.value,
            from: format!("line {}", point.line),
        });
        let seen: Vec<Seen> = seen.collect();
        self.unknowns.fit(&scene, &seen, &self.data, (&self.fitting, &self.files))
    }
}

impl Run {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let about = about(&self.log);
        let log = record::read(&self.log).map_err(Failure::new)?;
        let scene = match &self.scene {
            Some(scene) => scene::load(scene)?,
            None => scene::parse(&log.info.scene_text, &format!("scene.toml of {}", self.log.display()))?,
        };
        let limb = Limb::new(&scene)?;
        let names: Vec<String> = limb.drives().map(|drive| drive.name()).collect();
        if !names.iter().eq(log.info.modules.iter().map(|module| &module.name)) {
            return Err(about(&format!("the log has other modules than the scene, which has {}", names.join(", "))));
        }
        let seen: Vec<Seen> = holds(&log)
            .into_iter()
            .map(|hold| Seen {
                module: limb.drive(hold.module).index,
                reading_pa: hold.reading_pa,
                quantity: hold.quantity,
                value: hold.value,
                from: format!("phase `{}`", hold.phase),
            })
            .collect();
        if seen.is_empty() {
            let text = "no hold in which a deformation was seen and the pressure stood still: give phases a hold";
            return Err(about(&text));
        }
        self.unknowns.fit(&scene, &seen, &self.log, (&self.fitting, &self.files))
    }
}

impl Unknowns {
    /// Fits the unknowns to the measurements of a file and finishes the command.
    fn fit(
        &self,
        scene: &Scene,
        seen: &[Seen],
        file: &Path,
        (fitting, files): (&Fitting, &Files),
    ) -> Result<Outcome, Failure> {
        let about = about(file);
        let bodies: Vec<Body> =
            scene.modules().iter().map(|module| Body::new(module.name.as_str(), module.actuator())).collect();
        let observations = observations(&bodies, seen, fitting.accuracy.si());
        let mut unknowns = Vec::new();
        for property in &self.fit {
            unknowns.extend(self.unknowns(scene, &bodies, seen, *property).map_err(|error| about(&error))?);
        }
        let fit = fit(&bodies, &observations, &unknowns, &fitting.settings()).map_err(|error| about(&error))?;
        let mut warnings: Vec<String> = fit
            .systematic(&observations)
            .into_iter()
            .map(|body| {
                let name = &bodies[body].name;
                format!("the residuals of {name} are not random: the model does not follow these data, and the intervals are too narrow")
            })
            .collect();
        warnings.extend(fit.outliers(&observations).into_iter().map(|k| {
            format!("{} stands out: {} is beyond four times the scatter of all", seen[k].from, observations[k].value)
        }));
        let measured =
            scene.modules().iter().enumerate().filter(|(index, _)| seen.iter().any(|of| of.module == *index));
        warnings.extend(measured.filter_map(|(_, module)| scene.winding_warning(module)));
        let written = self.fit.iter().any(|p| !matches!(p, Property::PressureOffset | Property::PressureGain));
        let wanted = fit.bodies.iter().map(|body| body.parameters).collect();
        let fitted = Fitted {
            table: table(&fit, &observations, fitting.confidence.si()),
            json: printed(&fit, &observations, seen),
            svg: picture(&fit, &observations),
            scene: written.then(|| (scene.clone(), wanted)),
            warnings,
        };
        fitted.finish(fitting, files)
    }

    /// A property as unknowns: one for each part or module that there are data about.
    fn unknowns(
        &self,
        scene: &Scene,
        bodies: &[Body],
        seen: &[Seen],
        property: Property,
    ) -> Result<Vec<Unknown>, String> {
        let kind = match (self.per, property.is_of_material(), property.is_of_winding()) {
            (Per::Part, true, _) => Some("material"),
            (Per::Part, _, true) => Some("winding"),
            _ => None,
        };
        let mut groups: Vec<(String, Unknown)> = Vec::new();
        for (index, body) in bodies.iter().enumerate() {
            if property.value(body).is_none() {
                continue;
            }
            let name = match kind {
                Some(kind) => scene.part_name(index, kind).unwrap_or_else(|| body.name.clone()),
                None => body.name.clone(),
            };
            match groups.iter_mut().find(|(other, _)| *other == name) {
                Some((_, unknown)) => unknown.bodies.push(index),
                None => groups.push((name, Unknown::of(property, index))),
            }
        }
        let told = |unknown: &Unknown| seen.iter().any(|of| unknown.bodies.contains(&of.module));
        let unknowns: Vec<Unknown> = groups.into_iter().map(|(_, unknown)| unknown).filter(told).collect();
        if unknowns.is_empty() {
            return Err(format!("no module of these data has a {property}"));
        }
        Ok(unknowns)
    }
}

/// Accuracy is a share of the largest deformation of its kind and module.
fn observations(bodies: &[Body], seen: &[Seen], accuracy: f64) -> Vec<Observation> {
    let size = |of: &Seen| {
        let rest = bodies[of.module].at_rest(of.quantity);
        let alike = seen.iter().filter(|other| other.module == of.module && other.quantity == of.quantity);
        let largest = alike.map(|other| (other.value - rest).abs()).fold(0.0, f64::max);
        // Where nothing moved the accuracy is that of the undeformed size.
        if largest > 0.0 { largest } else { rest.abs().max(1e-3) }
    };
    seen.iter()
        .map(|of| Observation {
            body: of.module,
            reading_pa: of.reading_pa,
            quantity: of.quantity,
            value: of.value,
            accuracy: accuracy * size(of),
        })
        .collect()
}

/// A value in the unit that people read it in.
fn shown(property: Property, value: f64) -> (f64, &'static str) {
    match property {
        Property::FiberAngle => (value.to_degrees(), "deg"),
        Property::Wall | Property::InnerRadius | Property::Length => (value * 1e3, "mm"),
        Property::PressureGain => (value, ""),
        Property::PressureOffset => (value, "Pa"),
        _ => (value * 1e-6, "MPa"),
    }
}

fn table(fit: &Fit, observations: &[Observation], confidence: f64) -> String {
    let interval = format!("{} % interval", 100.0 * confidence);
    let names: Vec<String> = fit
        .estimates
        .iter()
        .map(|estimate| match shown(estimate.property, 0.0).1 {
            "" => estimate.name.clone(),
            unit => format!("{}, {unit}", estimate.name),
        })
        .collect();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let mut text = format!("{:<width$} {:>12} {interval:>27} {:>12}\n", "", "value", "start");
    for (name, estimate) in names.iter().zip(&fit.estimates) {
        let in_unit = |value| shown(estimate.property, value).0;
        let [low, high] = estimate.interval.map(in_unit);
        let (value, start) = (in_unit(estimate.value), in_unit(estimate.start));
        let _ = writeln!(text, "{name:<width$} {value:>12.6} {low:>12.6} to {high:>11.6} {start:>12.6}");
    }
    let _ = writeln!(
        text,
        "\n{:<16} {:<15} {:>7} {:>14} {:>14}",
        "module", "quantity", "points", "rms before", "rms after"
    );
    for (index, body) in fit.bodies.iter().enumerate() {
        let mut done: Vec<StateQuantity> = Vec::new();
        for seen in observations.iter().filter(|seen| seen.body == index) {
            if done.contains(&seen.quantity) {
                continue;
            }
            done.push(seen.quantity);
            let of: Vec<usize> = (0..observations.len())
                .filter(|k| observations[*k].body == index && observations[*k].quantity == seen.quantity)
                .collect();
            let rms = |model: &dyn Fn(usize) -> f64| {
                let sum: f64 = of.iter().map(|k| (model(*k) - observations[*k].value).powi(2)).sum();
                seen.quantity.display_scale() * (sum / of.len() as f64).sqrt()
            };
            let before = rms(&|k| fit.before[k].unwrap_or(f64::NAN));
            let before = if before.is_finite() { format!("{before:.5}") } else { "past its limit".into() };
            let unit = seen.quantity.display_unit();
            let after = rms(&|k| fit.after[k]);
            let label = seen.quantity.label();
            let _ = writeln!(text, "{:<16} {label:<15} {:>7} {before:>14} {after:>14.5} {unit}", body.name, of.len());
        }
    }
    text
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed {
    estimates: Vec<PrintedEstimate>,
    scatter: f64,
    degrees_of_freedom: usize,
    condition: f64,
    correlation: Vec<Vec<f64>>,
    points: Vec<PrintedPoint>,
}

#[derive(Serialize)]
struct PrintedEstimate {
    property: &'static str,
    unit: &'static str,
    modules: Vec<String>,
    start: f64,
    value: f64,
    standard_deviation: f64,
    interval: [f64; 2],
}

#[derive(Serialize)]
struct PrintedPoint {
    module: String,
    from: String,
    pressure_pa: f64,
    quantity: &'static str,
    measured: f64,
    before: Option<f64>,
    after: f64,
}

fn printed(fit: &Fit, observations: &[Observation], seen: &[Seen]) -> Printed {
    let estimates = fit.estimates.iter().map(|estimate| PrintedEstimate {
        property: estimate.property.word(),
        unit: estimate.property.si_unit(),
        modules: estimate.bodies.iter().map(|body| fit.bodies[*body].name.clone()).collect(),
        start: estimate.start,
        value: estimate.value,
        standard_deviation: estimate.standard_deviation,
        interval: estimate.interval,
    });
    let points = observations.iter().zip(seen).enumerate().map(|(k, (observation, seen))| PrintedPoint {
        module: fit.bodies[observation.body].name.clone(),
        from: seen.from.clone(),
        pressure_pa: observation.reading_pa,
        quantity: observation.quantity.name(),
        measured: observation.value,
        before: fit.before[k],
        after: fit.after[k],
    });
    Printed {
        estimates: estimates.collect(),
        scatter: fit.scatter,
        degrees_of_freedom: fit.freedom,
        condition: fit.condition,
        correlation: fit.correlation.clone(),
        points: points.collect(),
    }
}
