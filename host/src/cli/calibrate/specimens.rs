//! Fits of several specimens, and the mean and spread of their values.

use std::fmt::{Display, Write};
use std::path::Path;

use serde::Serialize;
use softlimb_rig::calibrate::{Estimate, Fit, Property, RandomEffects, SPECIMENS_MIN, random_effects};
use softlimb_scene::{Scene, WoundActuator};

use super::super::shared::about;
use super::super::{Failure, Outcome};
use super::pressure::{Seen, Source};
use super::print::{PrintedModel, printed_models, shown};
use super::{Files, Fitted, Fitting, Unknowns, Wanted};

/// Measurements of one specimen.
pub(super) struct Specimen {
    pub(super) name: String,
    pub(super) seen: Vec<Seen>,
    pub(super) warnings: Vec<String>,
}

/// The fit of a specimen.
struct OfSpecimen {
    name: String,
    fit: Fit,
    models: Vec<PrintedModel>,
}

/// Fits each specimen by itself, and finishes the command with the mean and spread of each value.
pub(super) fn fit(
    specimens: Vec<Specimen>,
    scene: &Scene,
    file: &Path,
    (unknowns, fitting, files): (&Unknowns, &Fitting, &Files),
) -> Result<Outcome, Failure> {
    let about = about(file);
    if specimens.len() < SPECIMENS_MIN {
        let text = format!("{} specimens: mean and spread take {SPECIMENS_MIN} or more", specimens.len());
        return Err(about(&text));
    }
    if files.svg.is_some() {
        return Err(Failure::wrong_line("--svg draws one specimen: give a file of it alone"));
    }
    let (mut fits, mut warnings) = (Vec::new(), Vec::new());
    for specimen in specimens {
        let mut source = Source::of_modules(scene, specimen.seen, None);
        source.warnings = specimen.warnings;
        let of_specimen = |error: &dyn Display| about(&format!("specimen `{}`: {error}", specimen.name));
        let (fit, observations, told) = unknowns.fitted(&source, &of_specimen, fitting)?;
        warnings.extend(told.into_iter().map(|told| format!("specimen `{}`: {told}", specimen.name)));
        let models = printed_models(&fit, &observations, &source);
        fits.push(OfSpecimen { name: specimen.name, fit, models });
    }
    warnings.sort();
    warnings.dedup();
    let first = &fits[0].fit;
    if let Some(other) = fits.iter().find(|of| of.fit.estimates.len() != first.estimates.len()) {
        let text = format!("specimen `{}` has data about other modules than `{}`", other.name, fits[0].name);
        return Err(about(&text));
    }
    let confidence = fitting.confidence.si();
    let mut effects = Vec::new();
    for (index, estimate) in first.estimates.iter().enumerate() {
        let of_all: Vec<(f64, f64)> = fits.iter().map(|specimen| of(&specimen.fit, index)).collect();
        let found = random_effects(&of_all, confidence);
        effects.push(found.ok_or_else(|| about(&format!("{} has no finite deviation", estimate.name)))?);
    }
    let fitted = Fitted {
        table: table(&fits, &effects, confidence),
        json: printed(&fits, &effects),
        svg: String::new(),
        scene: unknowns.written().then(|| (scene.clone(), Wanted::Actuators(means(scene, first, &effects)))),
        warnings,
    };
    fitted.finish(fitting, files)
}

/// Value and standard deviation of an estimate.
fn of(fit: &Fit, index: usize) -> (f64, f64) {
    let estimate = &fit.estimates[index];
    (estimate.value, estimate.standard_deviation)
}

/// The parameters of each module with the means.
fn means(scene: &Scene, fit: &Fit, effects: &[RandomEffects]) -> Vec<WoundActuator> {
    let mut bodies = fit.bodies.clone();
    for (estimate, effect) in fit.estimates.iter().zip(effects) {
        for body in &estimate.bodies {
            estimate.property.place(&mut bodies[*body], effect.mean);
        }
    }
    bodies.into_iter().take(scene.modules().len()).map(|body| (body.parameters, body.second_fiber)).collect()
}

fn table(fits: &[OfSpecimen], effects: &[RandomEffects], confidence: f64) -> String {
    let interval = format!("{} % interval", 100.0 * confidence);
    let mut text = String::new();
    for (index, (estimate, effect)) in fits[0].fit.estimates.iter().zip(effects).enumerate() {
        let (_, unit) = shown(estimate.property, 0.0);
        let label = if unit.is_empty() { estimate.name.clone() } else { format!("{}, {unit}", estimate.name) };
        let _ = writeln!(text, "{label}\n  {:<20} {:>12} {interval:>27}", "", "value");
        let mut row = |name: &str, value: f64, [low, high]: [f64; 2]| {
            let [value, low, high] = [value, low, high].map(|value| shown(estimate.property, value).0);
            let _ = writeln!(text, "  {name:<20} {value:>12.6} {low:>12.6} to {high:>11.6}");
        };
        for OfSpecimen { name, fit, .. } in fits {
            let Estimate { value, interval, .. } = fit.estimates[index];
            row(name, value, interval);
        }
        row("mean", effect.mean, effect.interval);
        row("between specimens", effect.spread, effect.spread_interval);
    }
    for OfSpecimen { name, models, .. } in fits {
        for model in models {
            let _ = writeln!(text, "{name}, {}", model.line());
        }
    }
    text
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    specimens: Vec<PrintedSpecimen<'a>>,
    random_effects: Vec<PrintedEffect>,
}

#[derive(Serialize)]
struct PrintedSpecimen<'a> {
    name: String,
    estimates: Vec<PrintedEstimate>,
    /// Of bending modules.
    models: &'a [PrintedModel],
}

#[derive(Serialize)]
struct PrintedEstimate {
    property: &'static str,
    modules: Vec<String>,
    value: f64,
    standard_deviation: f64,
    interval: [f64; 2],
}

#[derive(Serialize)]
struct PrintedEffect {
    property: &'static str,
    unit: &'static str,
    modules: Vec<String>,
    mean: f64,
    interval: [f64; 2],
    /// Standard deviation between specimens.
    spread: f64,
    spread_interval: [f64; 2],
}

fn printed<'a>(fits: &'a [OfSpecimen], effects: &[RandomEffects]) -> Printed<'a> {
    let modules = |fit: &Fit, estimate: &Estimate| -> Vec<String> {
        estimate.bodies.iter().map(|body| fit.bodies[*body].name.clone()).collect()
    };
    let word = |property: Property| property.word();
    let specimens = fits.iter().map(|OfSpecimen { name, fit, models }| PrintedSpecimen {
        models,
        name: name.clone(),
        estimates: fit
            .estimates
            .iter()
            .map(|estimate| PrintedEstimate {
                property: word(estimate.property),
                modules: modules(fit, estimate),
                value: estimate.value,
                standard_deviation: estimate.standard_deviation,
                interval: estimate.interval,
            })
            .collect(),
    });
    let first = &fits[0].fit;
    let random_effects = first.estimates.iter().zip(effects).map(|(estimate, effect)| PrintedEffect {
        property: word(estimate.property),
        unit: estimate.property.si_unit(),
        modules: modules(first, estimate),
        mean: effect.mean,
        interval: effect.interval,
        spread: effect.spread,
        spread_interval: effect.spread_interval,
    });
    Printed { specimens: specimens.collect(), random_effects: random_effects.collect() }
}
