//! Errors of the tip: at the targets, at rest, on the whole way.

use nalgebra::Vector3;

use crate::record::Sample;
use softlimb_limb::Limb;
use softlimb_motion::{Plan, PlannedPhase, tip_slopes};
use softlimb_numerics::statistics::mean;

/// Time at the end of a pause over which the tip's position at the target is taken, s: ten samples by default.
const WINDOW_S: f64 = 0.2;
/// Time at the beginning of a pause in which the limb comes to rest, s.
pub(super) const SETTLING_S: f64 = 0.3;
/// Shortest pause with a target, s.
pub(super) const REST_S: f64 = SETTLING_S + WINDOW_S;

/// Root of the mean square, and the largest, of distances, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distances {
    sum_m2: f64,
    count: usize,
    /// The largest, m.
    pub max_m: f64,
}

impl Distances {
    pub(super) fn add(&mut self, error_m: &Vector3<f64>) {
        self.sum_m2 += error_m.norm_squared();
        self.count += 1;
        self.max_m = self.max_m.max(error_m.norm());
    }

    /// Root of the mean square, m; 0 of none.
    pub fn rmse_m(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.sum_m2 / self.count as f64).sqrt() }
    }
}

/// One target over all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetScore {
    /// Name of the phase that ends there.
    pub phase: String,
    /// Error of the tip in each run, m: the mean over the last 0.2 s of the pause.
    pub errors_m: Vec<Vector3<f64>>,
}

impl TargetScore {
    /// The errors of all runs.
    pub fn distances(&self) -> Distances {
        let mut all = Distances::default();
        self.errors_m.iter().for_each(|error| all.add(error));
        all
    }

    /// The mean error, m: the systematic part.
    pub fn mean_m(&self) -> Vector3<f64> {
        mean(self.errors_m.iter().copied()).unwrap_or_default()
    }

    /// Distance of the runs from their mean, RMS, m: the random part. 0 of a single one.
    pub fn repeatability_m(&self) -> f64 {
        let middle = self.mean_m();
        let square: f64 = self.errors_m.iter().map(|error| (error - middle).norm_squared()).sum();
        (square / self.errors_m.len().saturating_sub(1).max(1) as f64).sqrt()
    }
}

/// Errors of the tip over some runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// The phases that rest at their goal.
    pub targets: Vec<TargetScore>,
    /// Single samples while the limb rests, from 0.3 s after a move on.
    pub at_rest: Distances,
    /// Single samples of the whole run.
    pub whole_way: Distances,
}

impl Score {
    pub(super) fn new(plan: &Plan) -> Self {
        let targets = plan.phases.iter().filter(|phase| rests(phase));
        let target = |phase: &PlannedPhase| TargetScore { phase: phase.name.clone(), errors_m: Vec::new() };
        Self { targets: targets.map(target).collect(), at_rest: Distances::default(), whole_way: Distances::default() }
    }

    /// All targets in all runs.
    pub fn at_targets(&self) -> Distances {
        let mut all = Distances::default();
        self.targets.iter().flat_map(|target| &target.errors_m).for_each(|error| all.add(error));
        all
    }

    /// Systematic error at the targets, RMS, m, and its standard error, m: that of a mean over the runs.
    pub fn systematic_m(&self) -> (f64, f64) {
        let count = self.targets.len().max(1) as f64;
        let square: f64 = self.targets.iter().map(|target| target.mean_m().norm_squared()).sum();
        let noise = self.targets.iter().map(|target| target.repeatability_m().powi(2) / target.errors_m.len() as f64);
        ((square / count).sqrt(), (noise.sum::<f64>() / count).sqrt())
    }

    /// Counts a run.
    pub(super) fn add(&mut self, plan: &Plan, samples: &[Sample]) {
        let end_s = plan.duration_us() as f64 * 1e-6;
        let errors: Vec<(f64, Vector3<f64>)> = errors_m(samples, end_s).collect();
        errors.iter().for_each(|(_, error)| self.whole_way.add(error));
        for (target, phase) in self.targets.iter_mut().zip(plan.phases.iter().filter(|phase| rests(phase))) {
            let (begin_s, end_s) = pause_s(phase);
            let within = |from_s: f64| {
                errors.iter().filter(move |(time_s, _)| *time_s > from_s && *time_s <= end_s).map(|(_, error)| *error)
            };
            within(begin_s + SETTLING_S).for_each(|error| self.at_rest.add(&error));
            target.errors_m.extend(mean(within(end_s - WINDOW_S)));
        }
    }
}

/// Times, s, and errors of the tip, m, up to an end.
pub(super) fn errors_m(samples: &[Sample], end_s: f64) -> impl Iterator<Item = (f64, Vector3<f64>)> {
    samples.iter().filter(move |sample| sample.time_s <= end_s).filter_map(|sample| {
        let error_m = Vector3::from(sample.tip_achieved_m?) - Vector3::from(sample.tip_setpoint_m);
        Some((sample.time_s, error_m))
    })
}

/// Begin and end of the pause of a phase, s.
pub(super) fn pause_s(phase: &PlannedPhase) -> (f64, f64) {
    let begin_us = phase.start_us + phase.move_us;
    (begin_us as f64 * 1e-6, (begin_us + phase.hold_us) as f64 * 1e-6)
}

/// Whether a phase rests at its goal for long enough to be evaluated.
fn rests(phase: &PlannedPhase) -> bool {
    phase.hold_us as f64 >= REST_S * 1e6
}

/// Whether there is a target.
pub(super) fn is_evaluated(plan: &Plan) -> bool {
    plan.phases.iter().any(rests)
}

/// Bound of the tip's error at a target, m, by errors of the device's inverse, Pa for each drive.
pub(super) fn inverse_m(limb: &Limb, plan: &Plan, errors_pa: Option<Vec<f64>>) -> Option<f64> {
    let errors_pa = errors_pa?;
    let at = |phase: &PlannedPhase| {
        let slopes = tip_slopes(limb, &plan.states_at(1e6 * pause_s(phase).1));
        slopes.iter().zip(&errors_pa).map(|((velocity, _), error_pa)| velocity.norm() * error_pa).sum::<f64>()
    };
    Some(plan.phases.iter().filter(|phase| rests(phase)).map(at).fold(0.0, f64::max))
}
