//! The error of the tip, split into its causes; and how near the limb came to an obstacle, beside its plan.

use nalgebra::Vector3;

use super::stats::distance;
use crate::record::{Body, NearestInfo, PhaseInfo, RunLog, Sample};

/// Time at the end of a phase over which the tip's position counts, s.
const WINDOW_S: f64 = 0.2;

/// Distances of the tip, m: they add as vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Causes {
    /// Achieved from the setpoint; `None` if the limb was not observed.
    pub(super) total_m: Option<f64>,
    /// Of the model at the achieved pressures from the setpoint.
    pub(super) pressure_m: f64,
    /// Of the limb from that model, at the same pressures; without weight where the setpoints do not compensate it.
    pub(super) model_m: Option<f64>,
    /// Of the limb from itself without weight, where the setpoints do not compensate it.
    pub(super) sag_m: Option<f64>,
}

impl Causes {
    /// The largest cause with its name; `None` where the error as a whole is not known.
    pub(super) fn largest(&self) -> Option<(&'static str, f64)> {
        self.total_m?;
        self.parts().into_iter().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The known causes with their names.
    pub(super) fn parts(&self) -> Vec<(&'static str, f64)> {
        let parts = [("pressure", Some(self.pressure_m)), ("model", self.model_m), ("sag", self.sag_m)];
        let known = parts.into_iter().filter_map(|(name, part)| Some((name, part?)));
        known.filter(|(_, part)| part.is_finite()).collect()
    }
}

/// A phase as it came out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome<'a> {
    pub(super) phase: &'a PhaseInfo,
    /// At the end of its hold, by the mean positions of the last 0.2 s; `None` where the run ended before.
    pub(super) tip: Option<Causes>,
    /// Where the limb came nearest to an obstacle.
    pub(super) nearest: Option<NearestInfo>,
}

/// Each phase as it came out.
pub(super) fn outcomes(log: &RunLog) -> Vec<Outcome<'_>> {
    let outcome = |phase| Outcome { phase, tip: at_end(log, phase), nearest: nearest(log, phase) };
    log.info.phases.iter().map(outcome).collect()
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
        pressure_m: distance(modelled, set),
        model_m: unloaded.or(achieved).map(|free| distance(free, modelled)),
        sag_m: achieved.zip(unloaded).map(|(achieved, unloaded)| distance(achieved, unloaded)),
    }
}

fn at_end(log: &RunLog, phase: &PhaseInfo) -> Option<Causes> {
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
    Some(causes(set, modelled, mean(&|sample| sample.tip_achieved_m), unloaded))
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
    fn error_is_split_into_distances_of_a_known_chain() {
        // 3 along x by the pressures, 4 along y by the model, 12 along z by the weight: 13 in all.
        let [set, modelled] = [[0.0; 3], [3.0, 0.0, 0.0]];
        let (unloaded, achieved) = ([3.0, 4.0, 0.0], [3.0, 4.0, 12.0]);
        let split = causes(set, modelled, Some(achieved), Some(unloaded));
        assert_eq!(split, Causes { total_m: Some(13.0), pressure_m: 3.0, model_m: Some(4.0), sag_m: Some(12.0) });
        assert_eq!(split.largest(), Some(("sag", 12.0)));
        let compensated = causes(set, modelled, Some([3.0, 4.0, 0.0]), None);
        assert_eq!(compensated, Causes { total_m: Some(5.0), pressure_m: 3.0, model_m: Some(4.0), sag_m: None });
        let unseen = causes(set, modelled, None, None);
        assert_eq!((unseen.total_m, unseen.model_m, unseen.largest()), (None, None, None));
    }
}
