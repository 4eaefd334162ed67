//! The error of the tip, split into its causes; and how near the limb came to an obstacle, beside its plan.

use nalgebra::Vector3;

use super::stats::distance;
use super::swing;
use crate::record::{Body, NearestInfo, PhaseInfo, RunLog, Sample, SolidShape};

/// Time at the end of a phase over which the tip's position counts, s.
const WINDOW_S: f64 = 0.2;
/// Error of the tip from which on it has missed its setpoint, over the length of the limb: scenes state no tolerance of a point.
pub(super) const TOLERANCE: f64 = 0.03;

/// Distances of the tip, m: they add as vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Causes {
    /// Achieved from the setpoint; `None` if the limb was not observed.
    pub(super) total_m: Option<f64>,
    /// Of the model at the achieved pressures from the setpoint; `None` with feedback, whose corrections take the model away from the setpoint.
    pub(super) pressure_m: Option<f64>,
    /// Of the limb from that model, at the same pressures; without weight where the setpoints do not compensate it; `None` with feedback, too.
    pub(super) model_m: Option<f64>,
    /// Of the limb from itself without weight, where the setpoints do not compensate it.
    pub(super) sag_m: Option<f64>,
}

/// A cause of the tip's error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cause {
    Pressure,
    Model,
    Sag,
}

impl Causes {
    /// The error without its causes.
    fn unsplit(self) -> Self {
        Self { pressure_m: None, model_m: None, sag_m: None, ..self }
    }

    /// The known causes, the largest first.
    pub(super) fn sorted(&self) -> Vec<(Cause, f64)> {
        let parts = [(Cause::Pressure, self.pressure_m), (Cause::Model, self.model_m), (Cause::Sag, self.sag_m)];
        let known = parts.into_iter().filter_map(|(cause, part)| Some((cause, part?)));
        let mut known: Vec<_> = known.filter(|(_, part)| part.is_finite()).collect();
        known.sort_by(|a, b| b.1.total_cmp(&a.1));
        known
    }
}

/// A phase as it came out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome<'a> {
    pub(super) phase: &'a PhaseInfo,
    /// At the end of its hold, by the mean positions of the last 0.2 s; `None` where the run ended before.
    pub(super) tip: Option<Causes>,
    /// Comparison with the goal; `None` where the limb was not observed, or nothing bounds its error.
    pub(super) goal: Option<GoalCheck<'a>>,
    /// Where the limb came nearest to an obstacle.
    pub(super) nearest: Option<NearestInfo>,
    /// Swing of the tip after the move, m; `None` where it was not seen.
    pub(super) swing_m: Option<f64>,
}

/// The tip at the end of a phase beside its goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum GoalCheck<'a> {
    /// Distance from the setpoint, and its tolerance, m.
    Point { error_m: f64, tolerance_m: f64 },
    /// Name of a region, and distance outside of it, m; 0 within.
    Region { name: &'a str, outside_m: f64 },
}

impl GoalCheck<'_> {
    pub(super) fn is_hit(&self) -> bool {
        match self {
            Self::Point { error_m, tolerance_m } => error_m <= tolerance_m,
            Self::Region { outside_m, .. } => *outside_m <= 0.0,
        }
    }
}

/// Each phase as it came out.
pub(super) fn outcomes(log: &RunLog) -> Vec<Outcome<'_>> {
    let length_m = length_m(log);
    let outcome = |phase| {
        let (tip, place_m) = at_end(log, phase).unzip();
        let tip = if log.info.is_corrected() { tip.map(Causes::unsplit) } else { tip };
        let goal = goal(log, phase, (tip.and_then(|tip| tip.total_m), place_m.flatten()), length_m);
        let swing_m = swing::seen_m(log, phase).filter(|_| tip.is_some());
        Outcome { phase, tip, goal, nearest: nearest(log, phase), swing_m }
    };
    log.info.phases.iter().map(outcome).collect()
}

/// Length of the limb at the start of the run, m: that of the first center line at the setpoints.
fn length_m(log: &RunLog) -> Option<f64> {
    let line = &log.shapes.first()?.setpoint;
    let length_m = line.windows(2).map(|pair| distance(pair[1], pair[0])).sum::<f64>();
    (length_m.is_finite() && length_m > 0.0).then_some(length_m)
}

/// The goal of a phase beside the error and the place of the tip, m.
fn goal<'a>(
    log: &'a RunLog,
    phase: &'a PhaseInfo,
    (error_m, place_m): (Option<f64>, Option<[f64; 3]>),
    length_m: Option<f64>,
) -> Option<GoalCheck<'a>> {
    let error_m = error_m.filter(|error_m| error_m.is_finite())?;
    let named = phase.region.as_deref().and_then(|name| {
        let solid = log.info.solids.iter().find(|solid| solid.region && solid.name == name)?;
        let Some(SolidShape::Box { center_m, half_axes_m }) = solid.shape else { return None };
        Some(GoalCheck::Region { name, outside_m: outside_m(place_m?, center_m, half_axes_m) })
    });
    named.or_else(|| Some(GoalCheck::Point { error_m, tolerance_m: TOLERANCE * length_m? }))
}

/// Distance of a point outside of a box, m; 0 within.
fn outside_m(place_m: [f64; 3], center_m: [f64; 3], half_axes_m: [[f64; 3]; 3]) -> f64 {
    let from_center = Vector3::from(place_m) - Vector3::from(center_m);
    let beyond = half_axes_m.map(|axis| {
        let axis = Vector3::from(axis);
        (from_center.dot(&axis.normalize()).abs() - axis.norm()).max(0.0)
    });
    Vector3::from(beyond).norm()
}

/// The distances at one sample; the sag is that at the time of a solid.
pub(super) fn at(sample: &Sample, body: Option<&Body>) -> Causes {
    let (set, modelled) = (sample.tip_setpoint_m, sample.tip_modelled_m);
    let unloaded = body.and_then(|body| body.tip_unloaded_m);
    causes(set, modelled, sample.tip_achieved_m, unloaded)
}

fn causes(set: [f64; 3], modelled: [f64; 3], achieved: Option<[f64; 3]>, unloaded: Option<[f64; 3]>) -> Causes {
    Causes {
        total_m: achieved.map(|achieved| distance(achieved, set)),
        pressure_m: Some(distance(modelled, set)),
        model_m: unloaded.or(achieved).map(|free| distance(free, modelled)),
        sag_m: achieved.zip(unloaded).map(|(achieved, unloaded)| distance(achieved, unloaded)),
    }
}

/// The distances at the end of a phase, and the place of the tip, m.
fn at_end(log: &RunLog, phase: &PhaseInfo) -> Option<(Causes, Option<[f64; 3]>)> {
    let end_s = phase.end_s();
    let from_s = phase.hold_start_s().max(end_s - WINDOW_S);
    let within = |time_s: f64| time_s >= from_s - 1e-6 && time_s <= end_s + 1e-6;
    let samples: Vec<&Sample> = log.samples.iter().filter(|sample| within(sample.time_s)).collect();
    // A run that was stopped has not come to the end of the phase.
    if log.samples.last()?.time_s + WINDOW_S < end_s {
        return None;
    }
    let mean = |point: &dyn Fn(&Sample) -> Option<[f64; 3]>| {
        let points: Option<Vec<Vector3<f64>>> = samples.iter().map(|sample| point(sample).map(Vector3::from)).collect();
        let points = points.filter(|points| !points.is_empty())?;
        Some((points.iter().sum::<Vector3<f64>>() / points.len() as f64).into())
    };
    let unloaded: Vec<Vector3<f64>> = log
        .bodies
        .iter()
        .filter(|body| within(body.time_s))
        .filter_map(|body| body.tip_unloaded_m.map(Vector3::from))
        .collect();
    let unloaded =
        (!unloaded.is_empty()).then(|| (unloaded.iter().sum::<Vector3<f64>>() / unloaded.len() as f64).into());
    let set = mean(&|sample| Some(sample.tip_setpoint_m))?;
    let modelled = mean(&|sample| Some(sample.tip_modelled_m))?;
    let achieved = mean(&|sample| sample.tip_achieved_m);
    Some((causes(set, modelled, achieved, unloaded), achieved))
}

fn nearest(log: &RunLog, phase: &PhaseInfo) -> Option<NearestInfo> {
    let within = |body: &&Body| body.time_s >= phase.start_s - 1e-6 && body.time_s <= phase.end_s() + 1e-6;
    let known = log.bodies.iter().filter(within).filter_map(|body| {
        let (distance_m, obstacle) = body.nearest.clone()?;
        distance_m.is_finite().then_some(NearestInfo { obstacle, distance_m, time_s: body.time_s })
    });
    known.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_outside_a_leaning_box_is_known() {
        // Axes of 3-4-5 triangles, half as long as 1, 2 and 3.
        let axes = [[0.6, 0.8, 0.0], [-1.6, 1.2, 0.0], [0.0, 0.0, 3.0]];
        let center = [10.0, 0.0, 0.0];
        let outside =
            |u: f64, v: f64, w: f64| outside_m([10.0 + 0.6 * u - 0.8 * v, 0.8 * u + 0.6 * v, w], center, axes);
        for (at, expected) in
            [((0.9, -1.9, 2.9), 0.0), ((1.5, 0.0, 0.0), 0.5), ((-4.0, 6.0, 0.0), 5.0), ((0.0, 0.0, -4.5), 1.5)]
        {
            assert!((outside(at.0, at.1, at.2) - expected).abs() < 1e-12, "{at:?}");
        }
    }

    #[test]
    fn error_is_split_into_distances_of_a_known_chain() {
        // 3 along x by the pressures, 4 along y by the model, 12 along z by the weight: 13 in all.
        let [set, modelled] = [[0.0; 3], [3.0, 0.0, 0.0]];
        let (unloaded, achieved) = ([3.0, 4.0, 0.0], [3.0, 4.0, 12.0]);
        let split = causes(set, modelled, Some(achieved), Some(unloaded));
        assert_eq!(split, Causes { total_m: Some(13.0), pressure_m: Some(3.0), model_m: Some(4.0), sag_m: Some(12.0) });
        assert_eq!(split.sorted(), [(Cause::Sag, 12.0), (Cause::Model, 4.0), (Cause::Pressure, 3.0)]);
        let compensated = causes(set, modelled, Some([3.0, 4.0, 0.0]), None);
        assert_eq!(compensated, Causes { total_m: Some(5.0), pressure_m: Some(3.0), model_m: Some(4.0), sag_m: None });
        let unseen = causes(set, modelled, None, None);
        assert_eq!((unseen.total_m, unseen.model_m, unseen.sorted()), (None, None, vec![(Cause::Pressure, 3.0)]));
    }
}
