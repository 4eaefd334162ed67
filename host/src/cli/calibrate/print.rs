//! Tables and JSON of a fit of pressures and deformations.

use std::fmt::Write;

use fra_model::StateQuantity;
use serde::Serialize;

use super::pressure::Source;
use crate::results::bend::two_degrees;
use softlimb_rig::calibrate::{Body, BodyModel, Branch, Fit, LimbHold, Loaded, Observation, Property, Reason};

/// A value in the unit that people read it in.
pub(super) fn shown(property: Property, value: f64) -> (f64, &'static str) {
    match property {
        Property::FiberAngle | Property::SecondFiberAngle => (value.to_degrees(), "deg"),
        Property::Wall | Property::InnerRadius | Property::Length => (value * 1e3, "mm"),
        Property::PressureGain => (value, ""),
        Property::SeatingPressure | Property::LoopWidth | Property::PressureOffset => (value, "Pa"),
        _ => (value * 1e-6, "MPa"),
    }
}

/// The table of a fit.
pub(super) fn table(
    fit: &Fit,
    observations: &[Observation],
    (source, models): (&Source<'_>, &[PrintedModel]),
    confidence: f64,
) -> String {
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
    for (index, module) in source.modules.iter().enumerate() {
        let name = source.scene.modules()[*module].name.as_str();
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
            let _ = writeln!(text, "{:<16} {label:<15} {:>7} {before:>14} {after:>14.5} {unit}", name, of.len());
        }
    }
    let tips = tips(fit, observations.len(), source.loaded);
    if !tips.is_empty() {
        let (before, after) = (rms_mm(&tips, |tip| tip.before), rms_mm(&tips, |tip| Some(tip.after)));
        let _ = writeln!(text, "{:<16} {:<15} {:>7} {before:>14} {after:>14} mm", "limb", "tip position", tips.len());
    }
    for model in models {
        let _ = writeln!(text, "{}", model.line());
    }
    text
}

/// The models of the bending bodies that there are data about.
pub(super) fn printed_models(fit: &Fit, observations: &[Observation], source: &Source<'_>) -> Vec<PrintedModel> {
    let bodies = source.modules.iter().zip(fit.bodies.iter().zip(&fit.models)).enumerate();
    let of = |(index, (module, (body, model))): (usize, (&usize, (&Body, &BodyModel)))| {
        let has_data = source.seen.iter().any(|seen| seen.module == *module);
        let (name, analytic_error) = match model {
            BodyModel::Tube => return None,
            BodyModel::AnalyticBend(error) => ("analytic", *error),
            BodyModel::SectionFe(Reason::Error(error)) => ("section-fe", Some(*error)),
            BodyModel::SectionFe(_) => ("section-fe", None),
        };
        has_data.then(|| PrintedModel {
            module: body.name.clone(),
            model: name,
            analytic_error,
            winding_2deg: body.winding_effect(observations, index, model.is_by_section()),
            text: model.to_string(),
        })
    };
    bodies.filter_map(of).collect()
}

/// The model of a bending body.
#[derive(Serialize)]
pub(super) struct PrintedModel {
    module: String,
    model: &'static str,
    /// Largest relative error that the analytic bend states at the readings.
    analytic_error: Option<f64>,
    /// Largest relative change of the bend if the winding is 2 deg off; `None` of benders with an ideal winding.
    winding_2deg: Option<f64>,
    /// In words, with the reason.
    text: String,
}

impl PrintedModel {
    /// As a line of a table.
    pub(super) fn line(&self) -> String {
        let off = self.winding_2deg.map_or(String::new(), two_degrees);
        format!("{}: {}{off}", self.module, self.text)
    }
}

/// Positions of the tip behind so many deformations of a fit.
fn tips(fit: &Fit, first: usize, loaded: Option<&Loaded<'_>>) -> Vec<PrintedTip> {
    let seen = loaded.iter().flat_map(|loaded| loaded.holds).filter_map(|hold| Some((hold, hold.tip_m?)));
    let of_hold = |(index, (hold, measured_m)): (usize, (&LimbHold, [f64; 3]))| {
        let at = |axis: usize| first + 3 * index + axis;
        let before = [0, 1, 2].map(|axis| fit.before[at(axis)]);
        PrintedTip {
            from: format!("phase `{}`", hold.phase),
            payload_kg: hold.payload_kg,
            measured: measured_m,
            before: before.iter().all(Option::is_some).then(|| before.map(Option::unwrap_or_default)),
            after: [0, 1, 2].map(|axis| fit.after[at(axis)]),
        }
    };
    seen.enumerate().map(of_hold).collect()
}

/// Root of the mean square distance of positions from the measured ones, mm.
fn rms_mm(tips: &[PrintedTip], of: impl Fn(&PrintedTip) -> Option<[f64; 3]>) -> String {
    let square = |tip: &PrintedTip| {
        Some(of(tip)?.iter().zip(&tip.measured).map(|(model, measured)| (model - measured).powi(2)).sum::<f64>())
    };
    match tips.iter().map(square).sum::<Option<f64>>() {
        Some(sum) => format!("{:.5}", 1e3 * (sum / tips.len() as f64).sqrt()),
        None => "falls".into(),
    }
}

/// The result of `--json`.
#[derive(Serialize)]
pub(super) struct Printed {
    estimates: Vec<PrintedEstimate>,
    scatter: f64,
    degrees_of_freedom: usize,
    condition: f64,
    correlation: Vec<Vec<f64>>,
    points: Vec<PrintedPoint>,
    /// Of bending bodies.
    models: Vec<PrintedModel>,
    /// Only of a limb under weight.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tips: Vec<PrintedTip>,
}

/// The tip in a hold, m.
#[derive(Serialize)]
struct PrintedTip {
    from: String,
    payload_kg: f64,
    measured: [f64; 3],
    before: Option<[f64; 3]>,
    after: [f64; 3],
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
    branch: &'static str,
    quantity: &'static str,
    measured: f64,
    before: Option<f64>,
    after: f64,
}

pub(super) fn printed(
    fit: &Fit,
    observations: &[Observation],
    source: &Source<'_>,
    models: Vec<PrintedModel>,
) -> Printed {
    let estimates = fit.estimates.iter().map(|estimate| PrintedEstimate {
        property: estimate.property.word(),
        unit: estimate.property.si_unit(),
        modules: estimate.bodies.iter().map(|body| fit.bodies[*body].name.clone()).collect(),
        start: estimate.start,
        value: estimate.value,
        standard_deviation: estimate.standard_deviation,
        interval: estimate.interval,
    });
    let points = observations.iter().zip(&source.seen).enumerate().map(|(k, (observation, seen))| PrintedPoint {
        module: source.scene.modules()[seen.module].name.value.clone(),
        from: seen.from.clone(),
        pressure_pa: observation.reading_pa,
        branch: if observation.branch == Branch::Loading { "loading" } else { "unloading" },
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
        models,
        tips: tips(fit, observations.len(), source.loaded),
    }
}
