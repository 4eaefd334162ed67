//! `softlimb calibrate pressure`: actuators from a table of pressures and deformations; and the fit that `calibrate run` has, too.

use fra_model::StateQuantity;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use clap::Args;

use super::super::shared::{about, read};
use super::super::{Failure, Outcome};
use super::print::{printed, printed_models, shown, table};
use super::specimens::{self, Specimen};
use super::{CHECK_UNITS, Files, Fitted, Fitting, Per, Unknowns, Wanted};
use softlimb_rig::calibrate::{
    Body, Branch, CalibrationError, Estimate, Fit, Loaded, Observation, Outlier, Points, Property, Unknown, fit,
    fit_loaded, picture,
};
use softlimb_scene as scene;
use softlimb_scene::{Scene, WoundActuator};

/// Factor between the fitted modulus and that of the scene beyond which the units of the columns are in doubt.
const FAR: f64 = 3.0;

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

/// Measurements and what they are of.
pub(super) struct Source<'a> {
    pub(super) scene: &'a Scene,
    /// Actuators that are taken as equal, and the module of each.
    pub(super) bodies: Vec<Body>,
    pub(super) modules: Vec<usize>,
    pub(super) seen: Vec<Seen>,
    /// Warnings about the measurements.
    pub(super) warnings: Vec<String>,
    /// The limb under its weight; `None` of actuators without load.
    pub(super) loaded: Option<&'a Loaded<'a>>,
}

impl<'a> Source<'a> {
    /// Modules, each of them a body.
    pub(super) fn of_modules(scene: &'a Scene, seen: Vec<Seen>, loaded: Option<&'a Loaded<'a>>) -> Self {
        let bodies = scene.modules().iter().map(|module| {
            let second_fiber = module.second_fiber.map(|fiber| *fiber);
            Body::new(module.name.as_str(), module.actuator()).with_second_fiber(second_fiber)
        });
        Self {
            scene,
            bodies: bodies.collect(),
            modules: (0..scene.modules().len()).collect(),
            seen,
            warnings: Vec::new(),
            loaded,
        }
    }

    /// The actuator of each module: the means of its bodies in what was fitted.
    pub(super) fn means(&self, fit: &Fit, properties: &[Property]) -> Vec<WoundActuator> {
        let of_module = |module: usize| {
            let own = || self.modules.iter().zip(&fit.bodies).filter(move |(of, _)| **of == module);
            let mut mean = own().next()?.1.clone();
            for property in properties {
                let values: Vec<f64> = own().filter_map(|(_, body)| property.value(body)).collect();
                if !values.is_empty() {
                    property.place(&mut mean, values.iter().sum::<f64>() / values.len() as f64);
                }
            }
            Some((mean.parameters, mean.second_fiber))
        };
        (0..self.scene.modules().len()).filter_map(of_module).collect()
    }
}

/// A measurement before its accuracy is known: module, reading, branch, quantity, value, and where it is from.
pub(super) struct Seen {
    pub(super) module: usize,
    pub(super) reading_pa: f64,
    pub(super) branch: Branch,
    pub(super) quantity: StateQuantity,
    pub(super) value: f64,
    pub(super) from: String,
}

impl Pressure {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, about) = (scene::load(&self.scene)?, about(&self.data));
        scene.require_no_segments("`calibrate`")?;
        let names: Vec<&str> = scene.modules().iter().map(|module| module.name.as_str()).collect();
        let points = Points::read(&read(&self.data)?, &names).map_err(|error| about(&error))?;
        if points.timed {
            let text = "a column time_s makes it the response to a step: use `softlimb calibrate creep`, or leave the column \
                        out of equilibria";
            return Err(about(&text));
        }
        let mut groups: Vec<(Option<String>, Vec<Seen>)> = Vec::new();
        for point in points.points {
            let seen = Seen {
                module: names.iter().position(|name| *name == point.name).unwrap_or(0),
                reading_pa: point.reading_pa,
                branch: point.branch,
                quantity: point.quantity,
                value: point.value,
                from: format!("line {}", point.line),
            };
            match groups.iter_mut().find(|(name, _)| *name == point.specimen) {
                Some((_, group)) => group.push(seen),
                None => groups.push((point.specimen, vec![seen])),
            }
        }
        if self.unknowns.per == Per::Actuator {
            return Err(Failure::wrong_line(
                "--per actuator takes a run under weight, which alone tells the actuators of a module apart",
            ));
        }
        if groups.iter().any(|(name, _)| name.is_some()) {
            let specimens = groups.into_iter().map(|(name, seen)| {
                let (seen, warnings) = distinct(seen);
                Specimen { name: name.unwrap_or_default(), seen, warnings }
            });
            let options = (&self.unknowns, &self.fitting, &self.files);
            return specimens::fit(specimens.collect(), &scene, &self.data, options);
        }
        let (seen, repeated) = distinct(groups.into_iter().flat_map(|(_, seen)| seen).collect());
        let mut source = Source::of_modules(&scene, seen, None);
        source.warnings = repeated;
        Ok(self.unknowns.fit(&source, &self.data, (&self.fitting, &self.files))?.1)
    }
}

/// The measurements without repetitions, and a warning for each that is repeated. A row that is written again to the last digit is one measurement:
/// counted as several, they would seem to scatter little, and the intervals would be too narrow.
fn distinct(seen: Vec<Seen>) -> (Vec<Seen>, Vec<String>) {
    let mut kept: Vec<(Seen, usize)> = Vec::new();
    for new in seen {
        let is_same = |old: &Seen| {
            (old.module, old.branch, old.quantity) == (new.module, new.branch, new.quantity)
                && (old.reading_pa, old.value) == (new.reading_pa, new.value)
        };
        match kept.iter_mut().find(|(old, _)| is_same(old)) {
            Some((_, count)) => *count += 1,
            None => kept.push((new, 1)),
        }
    }
    let told = |(seen, count): &(Seen, usize)| {
        (*count > 1).then(|| format!("{} is repeated {} times to the last digit: it counts once", seen.from, count - 1))
    };
    let mut warnings: Vec<String> = kept.iter().filter_map(told).collect();
    // A row has several quantities.
    warnings.dedup();
    (kept.into_iter().map(|(seen, _)| seen).collect(), warnings)
}

/// A warning of a modulus far from that of the scene: pressures in another unit give one without a residual.
fn far_from_start(estimate: &Estimate) -> Option<String> {
    if !matches!(estimate.property, Property::ShearModulus | Property::YeohC1) {
        return None;
    }
    let ratio = estimate.value / estimate.start;
    let [(value, unit), (start, _)] = [estimate.value, estimate.start].map(|value| shown(estimate.property, value));
    let text = || {
        let name = &estimate.name;
        format!("fitted {name}, {value:.6} {unit}, is {ratio:.3} times the scene's {start:.6} {unit}: {CHECK_UNITS}")
    };
    (!(1.0 / FAR..=FAR).contains(&ratio)).then(text)
}

impl Unknowns {
    /// Whether a scene has a place for one of the unknowns.
    pub(super) fn written(&self) -> bool {
        let has_none = |p: &Property| {
            matches!(
                p,
                Property::SeatingPressure | Property::LoopWidth | Property::PressureOffset | Property::PressureGain
            )
        };
        !self.fit.iter().all(has_none)
    }

    /// Fits the unknowns to measurements, which `about` names in errors; the fit with its observations and warnings.
    pub(super) fn fitted(
        &self,
        source: &Source<'_>,
        about: &dyn Fn(&dyn Display) -> Failure,
        fitting: &Fitting,
    ) -> Result<(Fit, Vec<Observation>, Vec<String>), Failure> {
        let Source { scene, bodies, seen, loaded, .. } = source;
        let observations = observations(source, fitting.accuracy.si());
        let mut unknowns = Vec::new();
        for property in &self.fit {
            unknowns.extend(self.unknowns(source, *property).map_err(|error| about(&error))?);
        }
        let fit = match loaded {
            Some(loaded) => fit_loaded(loaded, bodies, &observations, &unknowns, &fitting.settings()),
            None => fit(bodies, &observations, &unknowns, &fitting.settings()),
        };
        let fit = fit.map_err(|error| match &error {
            CalibrationError::NotReproduced { point, .. } => about(&format!("{error}. It is {}", seen[*point].from)),
            _ => about(&error),
        })?;
        let mut warnings = source.warnings.clone();
        warnings.extend(fit.systematic(&observations).into_iter().map(|body| {
                let name = &bodies[body].name;
                format!("the residuals of {name} are not random: the model does not follow these data, and the intervals are too narrow")
            }));
        warnings.extend(fit.outliers(&observations).into_iter().map(|Outlier { index, off, ratio }| {
            let (from, Observation { quantity, value, .. }) = (&seen[index].from, observations[index]);
            let shown = |value: f64| format!("{:.4} {}", value * quantity.display_scale(), quantity.display_unit());
            let [value, off] = [value, off].map(|value| shown(value).trim_end().to_owned());
            format!(
                "{from} is an outlier: {value} is {off} from the fit to the other rows (studentized residual {ratio:.1})"
            )
        }));
        warnings.extend(fit.estimates.iter().filter_map(far_from_start));
        let measured = source.modules.iter().zip(&fit.models);
        let measured = measured.filter(|(module, _)| seen.iter().any(|of| of.module == **module));
        for (module, model) in measured {
            if !model.is_by_section() {
                warnings.extend(scene.winding_warning(&scene.modules()[*module]));
            }
        }
        Ok((fit, observations, warnings))
    }

    /// Fits the unknowns to the measurements of a file and finishes the command.
    pub(super) fn fit(
        &self,
        source: &Source<'_>,
        file: &Path,
        (fitting, files): (&Fitting, &Files),
    ) -> Result<(Fit, Outcome), Failure> {
        let (fit, observations, warnings) = self.fitted(source, &about(file), fitting)?;
        let models = printed_models(&fit, &observations, source);
        let fitted = Fitted {
            table: table(&fit, &observations, (source, &models), fitting.confidence.si()),
            json: printed(&fit, &observations, source, models),
            svg: picture(&fit, &observations),
            scene: self.written().then(|| (source.scene.clone(), Wanted::Actuators(source.means(&fit, &self.fit)))),
            warnings,
        };
        let outcome = fitted.finish(fitting, files)?;
        Ok((fit, outcome))
    }

    /// A property as unknowns: one for each part, module or actuator that there are data about.
    fn unknowns(&self, source: &Source<'_>, property: Property) -> Result<Vec<Unknown>, String> {
        let part = |module: usize| match self.per {
            Per::Part if property.is_of_material() => source.scene.part_name(module, "material"),
            Per::Part if property.is_of_winding() => source.scene.part_name(module, "winding"),
            Per::Part if property.is_of_second_winding() => source.scene.second_winding_name(module),
            _ => None,
        };
        let mut groups: Vec<(String, Unknown)> = Vec::new();
        for (index, (body, module)) in source.bodies.iter().zip(&source.modules).enumerate() {
            if property.value(body).is_none() {
                continue;
            }
            let name = part(*module).unwrap_or_else(|| body.name.clone());
            match groups.iter_mut().find(|(other, _)| *other == name) {
                Some((_, unknown)) => unknown.bodies.push(index),
                None => groups.push((name, Unknown::of(property, index))),
            }
        }
        let told = |unknown: &Unknown| {
            let module = |body: &usize| source.modules[*body];
            source.seen.iter().any(|of| unknown.bodies.iter().map(module).any(|module| module == of.module))
        };
        let unknowns: Vec<Unknown> = groups.into_iter().map(|(_, unknown)| unknown).filter(told).collect();
        if unknowns.is_empty() {
            return Err(format!("no module of these data has a {property}"));
        }
        Ok(unknowns)
    }
}

/// Accuracy is a share of the largest deformation of its kind and module. The deformation of a module with several bodies counts for the first.
fn observations(source: &Source<'_>, accuracy: f64) -> Vec<Observation> {
    let body = |of: &Seen| source.modules.iter().position(|module| *module == of.module).unwrap_or(0);
    let size = |of: &Seen| {
        let rest = source.bodies[body(of)].at_rest(of.quantity);
        let alike = source.seen.iter().filter(|other| other.module == of.module && other.quantity == of.quantity);
        let largest = alike.map(|other| (other.value - rest).abs()).fold(0.0, f64::max);
        // Where nothing moved the accuracy is that of the undeformed size.
        if largest > 0.0 { largest } else { rest.abs().max(1e-3) }
    };
    let observation = |of: &Seen| Observation {
        body: body(of),
        reading_pa: of.reading_pa,
        branch: of.branch,
        quantity: of.quantity,
        value: of.value,
        accuracy: accuracy * size(of),
    };
    source.seen.iter().map(observation).collect()
}
