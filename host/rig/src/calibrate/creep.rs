//! Creep from the response to a step of the pressure.
//!
//! `q(t) = q_rest + a (1 + x (1 - exp(-t/tau)))`: what follows slowly is a share `x` of what follows at once, `docs/explanation/plant.md`. There the
//! share is one of the volume's change; it is the same of a deformation that grows in proportion to the volume.

use nalgebra::{DMatrix, DVector};

use super::descent::{Local, descend};
use super::estimate::{Column, Shown, Value, enough, judge};
use super::{CalibrationError, Settings};

const NAMES: [&str; 3] = ["immediate", "creep_share", "creep_time_s"];

/// Largest number of points for which each is left out in turn to find an outlier.
const FEW: usize = 50;
/// Distance of an outlier from the fit to the other points, in units of the accuracy.
const FAR_OFF: f64 = 10.0;

/// A series of deformations after the pressure was raised at time 0 and held.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Deformation before the step, in any unit.
    pub rest: f64,
    /// Time since the step, s, and the deformation at it, in the same unit.
    pub points: Vec<[f64; 2]>,
    /// Standard deviation of a deformation; > 0.
    pub accuracy: f64,
}

/// Creep that fits a series.
#[derive(Clone, Debug, PartialEq)]
pub struct CreepFit {
    /// The immediate response, in the unit of the series; the share that creeps, of that; its time constant, s.
    pub values: Vec<Value>,
    /// The deformation at each point.
    pub modelled: Vec<f64>,
}

/// Finds what follows at once, the share that creeps, and its time constant.
///
/// # Errors
/// [`CalibrationError`]; above all where the series is too short to tell how far the creep goes and how fast.
pub fn fit_creep(step: &Step, settings: &Settings) -> Result<CreepFit, CalibrationError> {
    fit_all(step, settings).map_err(|error| match error {
        CalibrationError::NotIdentified { .. } | CalibrationError::NotReproduced { .. } if step.points.len() <= FEW => {
            the_one_off(step, settings).unwrap_or(error)
        }
        _ => error,
    })
}

/// Error that names an outlier: a point far from an accepted fit to the others.
fn the_one_off(step: &Step, settings: &Settings) -> Option<CalibrationError> {
    let without = |point: usize| {
        let mut others = step.clone();
        let [time, seen] = others.points.remove(point);
        let found = fit_all(&others, settings).ok()?;
        let [a, share, tau] = &found.values[..] else { return None };
        let model = step.rest + a.value * (1.0 + share.value * (1.0 - (-time / tau.value).exp()));
        Some(((model - seen) / step.accuracy).abs()).filter(|off| *off > FAR_OFF).map(|off| (point, off))
    };
    let (point, off) = (0..step.points.len()).filter_map(without).max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(CalibrationError::NotReproduced { names: NAMES.map(str::to_owned).to_vec(), off, point })
}

fn fit_all(step: &Step, settings: &Settings) -> Result<CreepFit, CalibrationError> {
    settings.check()?;
    let points = &step.points;
    enough(points.len(), NAMES.len(), settings.noise)?;
    let invalid =
        |field, value, allowed| CalibrationError::Invalid { field, value, place: "the series".into(), allowed };
    if !(step.accuracy.is_finite() && step.accuracy > 0.0) {
        return Err(invalid("accuracy", step.accuracy, "finite and > 0"));
    }
    if let Some(point) = points.iter().find(|point| !(point[0] >= 0.0 && point[0].is_finite() && point[1].is_finite()))
    {
        return Err(invalid("time_s", point[0], "finite and >= 0, with a finite deformation"));
    }
    let mut ordered = points.clone();
    ordered.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (first, last) = (ordered[0], ordered[ordered.len() - 1]);
    let size = last[1] - step.rest;
    if size.abs() <= step.accuracy || last[0] <= first[0] {
        return Err(invalid("deformation", last[1], "different from that at rest, at more than one time"));
    }
    let half = first[1] + 0.63 * (last[1] - first[1]);
    let crossed =
        ordered.iter().find(|point| (point[1] - half) * (last[1] - first[1]) >= 0.0).map_or(last[0], |p| p[0]);
    let time = crossed.max(0.02 * last[0]);
    let immediate = first[1] - step.rest;
    let immediate = if immediate.abs() > 0.1 * size.abs() { immediate } else { size };
    // In units of the whole deformation, of itself, and as the logarithm of the time.
    let start = DVector::from_vec(vec![immediate / size, 0.05, time.ln()]);
    let shortest = ordered.iter().map(|point| point[0]).find(|time| *time > 0.0).unwrap_or(last[0]);
    let [least, most] = [1e-3 * shortest, 1e3 * last[0]];
    let at = |place: &DVector<f64>| {
        let [a, share, time] = [place[0] * size, place[1], place[2].exp()];
        // The points cannot distinguish creep with such a time constant from a step or a drift.
        if !(least..=most).contains(&time) {
            return Err(CalibrationError::NotSettled { steps: 0 });
        }
        let mut local = Local { residuals: DVector::zeros(points.len()), jacobian: DMatrix::zeros(points.len(), 3) };
        for (row, point) in points.iter().enumerate() {
            let left = (-point[0] / time).exp();
            let model = step.rest + a * (1.0 + share * (1.0 - left));
            local.residuals[row] = (model - point[1]) / step.accuracy;
            let slopes = [size * (1.0 + share * (1.0 - left)), a * (1.0 - left), -a * share * left * point[0] / time];
            slopes.iter().enumerate().for_each(|(k, slope)| local.jacobian[(row, k)] = slope / step.accuracy);
        }
        Ok::<_, CalibrationError>(local)
    };
    let end = descend(start, at)?;
    let time = end.place[2].exp();
    let values = [end.place[0] * size, end.place[1], time];
    let tolerances = [0.5 * values[0].abs(), 0.5 * values[1].abs(), 0.5 * time];
    let units = [size, 1.0, time];
    let columns: Vec<Column> = (0..3)
        .map(|k| Column {
            name: NAMES[k].into(),
            shown: Shown::Percent,
            value: values[k],
            tolerance: tolerances[k].max(f64::MIN_POSITIVE),
        })
        .collect();
    let scaled = DMatrix::from_fn(points.len(), 3, |i, k| end.local.jacobian[(i, k)] * columns[k].tolerance / units[k]);
    let advice = "Measure for two or three time constants, from the first tenth of one on; a share too small to be seen has no time.";
    let judged = judge(&columns, &end.local.residuals, &scaled, settings, |_| advice.into())?;
    if !end.settled {
        return Err(CalibrationError::NotSettled { steps: end.steps });
    }
    let modelled = points.iter().zip(&end.local.residuals).map(|(point, r)| point[1] + r * step.accuracy).collect();
    Ok(CreepFit { values: judged.values(&NAMES, &columns), modelled })
}
