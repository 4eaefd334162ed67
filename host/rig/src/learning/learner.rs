//! One limb's corrections, iteration by iteration.
//!
//! The tip is off by `e(t)`. Moving the setpoints by `du` moves the tip by `J du`, with the model's `J` at the planned pose and load, so
//! the corrections at instants along the run grow by the `du` that minimises `|J du + e|^2 + (|e| |du/range|)^2` within the modules' ranges. The
//! second term leaves alone what hardly moves the tip. Under weight each extending actuator is corrected by itself: unequal actuators bend
//! their bundle, and unequal setpoints bend it back, or make up for what other modules do out of their planes. The actuators of other modules are
//! corrected alike, and all without weight, where the simulated limb averages them.
//!
//! The first iterations have a gain of one, later ones the gain that makes the corrections a mean, because the valves' error differs from run to
//! run. Where the observed error has doubled since its least, as near a limit point, where a limb moves several times as far as its model, the
//! corrections of the run with the least error are restored, and later gains are halved.

use std::ops::Range;

use nalgebra::Vector3;

use super::score::{SETTLING_S, errors_m, pause_s};
use crate::camera::Camera;
use crate::correction::{Columns, columns, groups};
use crate::record::Sample;
use crate::run::Prepared;
use softlimb_limb::Limb;
use softlimb_motion::{Plan, planned_slopes, vibrations};
use softlimb_scene::{Corrections, SceneError};

/// Time between instants of the corrections while the limb moves, and at most while it rests, s; on a limb under weight no less than the period of its slowest
/// vibration.
const MOVING_S: f64 = 0.1;
const RESTING_S: f64 = 0.5;
/// Iterations with a gain of one.
const FULL: u32 = 2;
/// Growth of the observed error over its least that noise does not explain.
const WORSE: f64 = 2.0;
/// Share of an instant's observations that must be left once its neighbours have theirs.
const LEAST_SHARE: f64 = 1e-3;

/// Learns the corrections of one limb in one scene.
pub(super) struct Learner<'a> {
    limb: &'a Limb,
    plan: &'a Plan,
    corrections: Corrections,
    /// For each instant, whether the limb rests there.
    resting: Vec<bool>,
    /// Drive and channels of all that is corrected alike.
    groups: Vec<(usize, Range<usize>)>,
    /// For each instant, how the tip moves, m, with the whole range of each group.
    columns: Vec<Vec<Vector3<f64>>>,
    iterations: u32,
    /// The run with the least error.
    best: Option<Best>,
    /// Factor of the gain.
    caution: f64,
    camera: Camera,
}

/// A run with the corrections that it had.
struct Best {
    /// Error observed at rest, RMS, m.
    observed_m: f64,
    corrections: Corrections,
    /// Error at each instant, m; `None` where none was observed.
    errors: Vec<Option<Vector3<f64>>>,
}

impl<'a> Learner<'a> {
    /// Without corrections.
    ///
    /// # Errors
    /// A diagnostic at the phase in which the limb falls.
    pub(super) fn new(model: &'a Prepared<'_>, camera: Camera) -> Result<Self, SceneError> {
        let (limb, plan) = (model.limb(), model.plan());
        let groups = groups(limb, plan.weighed().is_some());
        let vibrations = vibrations(model.scene(), limb, plan)?;
        let period_s = vibrations.iter().map(|pose| 1.0 / pose.frequency_hz[0]).fold(0.0, f64::max);
        let (times_s, resting): (Vec<_>, Vec<_>) = instants(plan, period_s).into_iter().unzip();
        let rows = vec![vec![0.0; limb.channels()]; times_s.len()];
        let columns = |time_s: &f64| columns(limb, &groups, &planned_slopes(model.scene(), limb, plan, 1e6 * time_s));
        let columns = times_s.iter().map(columns).collect();
        let corrections = Corrections { times_s, rows };
        Ok(Self { limb, plan, corrections, resting, groups, columns, iterations: 0, best: None, caution: 1.0, camera })
    }

    /// The present corrections.
    pub(super) fn corrections(&self) -> &Corrections {
        &self.corrections
    }

    /// Updates the corrections by a run with the present ones; gives the observed error at rest, RMS, m, or `None` where the camera saw no tip at rest.
    pub(super) fn update(&mut self, samples: &[Sample]) -> Option<f64> {
        self.iterations += 1;
        let end_s = self.plan.duration_us() as f64 * 1e-6;
        let errors = errors_m(samples, end_s);
        self.camera.restart();
        let seen = errors.filter_map(|(time_s, error)| Some((time_s, self.camera.image(time_s, &error)?)));
        let observations: Vec<(f64, Vector3<f64>)> = seen.collect();
        let rests: Vec<_> = self.plan.phases.iter().map(pause_s).collect();
        let is_rest = |time_s: f64| rests.iter().any(|(begin, end)| time_s > begin + SETTLING_S && time_s <= *end);
        let seen = observations.iter().filter(|(time_s, _)| is_rest(*time_s)).map(|(_, error)| error.norm_squared());
        let (sum, count) = seen.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
        if count == 0 {
            return None;
        }
        let observed_m = (sum / f64::from(count)).sqrt();
        let mut errors = self.errors(&observations);
        match &self.best {
            Some(best) if observed_m > WORSE * best.observed_m => {
                (self.corrections, errors) = (best.corrections.clone(), best.errors.clone());
                self.caution *= 0.5;
            }
            Some(best) if observed_m >= best.observed_m => {}
            _ => {
                let corrections = self.corrections.clone();
                self.best = Some(Best { observed_m, corrections, errors: errors.clone() });
            }
        }
        self.correct(&errors);
        Some(observed_m)
    }

    /// The error at each instant, m, such that straight lines between them fit the observations of a pause by least squares; of a move the mean
    /// around each instant, which says nothing about what happens faster than the limb follows. What is off in a move is no matter of the
    /// instants of a pause: limbs are off by much more while they move. `None` without observations.
    fn errors(&self, observations: &[(f64, Vector3<f64>)]) -> Vec<Option<Vector3<f64>>> {
        let times = &self.corrections.times_s;
        // The normal equations: each instant has to do with itself and the next one.
        let mut own = vec![0.0; times.len()];
        let mut with_next = vec![0.0; times.len()];
        let mut sums = vec![Vector3::zeros(); times.len()];
        for (time_s, error) in observations {
            let after = times.partition_point(|time| time <= time_s).clamp(1, times.len() - 1);
            let share = ((time_s - times[after - 1]) / (times[after] - times[after - 1])).clamp(0.0, 1.0);
            let rests = self.resting[after - 1] && self.resting[after];
            for (index, weight) in [(after - 1, 1.0 - share), (after, share)] {
                if rests || !self.resting[index] {
                    sums[index] += error * weight;
                    own[index] += if rests { weight * weight } else { weight };
                }
            }
            if rests {
                with_next[after - 1] += share * (1.0 - share);
            }
        }
        solved(own, &with_next, sums)
    }

    fn correct(&mut self, errors: &[Option<Vector3<f64>>]) {
        let gain = self.caution / f64::from(self.iterations.saturating_sub(FULL - 1).max(1));
        for (index, error) in errors.iter().enumerate().filter_map(|(index, error)| Some((index, (*error)?))) {
            let time_us = self.corrections.times_s[index] * 1e6;
            let planned = self.plan.values_at(time_us);
            let planned: Vec<f64> = self.groups.iter().map(|(drive, _)| planned[*drive]).collect();
            let row = &mut self.corrections.rows[index];
            let mut values: Vec<f64> = self.groups.iter().map(|(_, channels)| row[channels.start]).collect();
            let columns = Columns { limb: self.limb, groups: &self.groups, columns: &self.columns[index] };
            let changes = columns.changes(&planned, &values, &error, gain);
            for ((value, change), (planned, (drive, _))) in
                values.iter_mut().zip(changes).zip(planned.iter().zip(&self.groups))
            {
                // Rounding takes nothing out of its range.
                let (low, high) = columns.range(*drive);
                *value = (planned + *value + change).clamp(low, high) - planned;
            }
            for ((_, channels), value) in self.groups.iter().zip(values) {
                row[channels.clone()].fill(value);
            }
        }
    }
}

/// The solution of equations whose matrix has `own` on its diagonal and `with_next` beside it; positive semidefinite. `None` where the diagonal
/// has nothing left.
fn solved(mut own: Vec<f64>, with_next: &[f64], mut right: Vec<Vector3<f64>>) -> Vec<Option<Vector3<f64>>> {
    let full = own.clone();
    let is_known = |own: &[f64], index: usize| own[index] > LEAST_SHARE * full[index];
    for index in 1..own.len() {
        if is_known(&own, index - 1) {
            let factor = with_next[index - 1] / own[index - 1];
            own[index] -= factor * with_next[index - 1];
            let before = right[index - 1];
            right[index] -= before * factor;
        }
    }
    let mut found: Vec<Option<Vector3<f64>>> = vec![None; own.len()];
    for index in (0..own.len()).rev().filter(|index| is_known(&own, *index)) {
        let next = found.get(index + 1).copied().flatten().unwrap_or_default();
        found[index] = Some((right[index] - next * with_next[index]) / own[index]);
    }
    found
}

/// Instants of the corrections, s, rising, from the start to the end of the last phase, two at least; and whether the limb rests there.
///
/// Neighbours are at least a period of the slowest vibration apart, where a move or a pause is that long. A lightly damped limb amplifies corrections at its
/// natural frequency: they would grow from run to run.
fn instants(plan: &Plan, period_s: f64) -> Vec<(f64, bool)> {
    let (moving_s, resting_s) = (MOVING_S.max(period_s), RESTING_S.max(period_s));
    let mut times = vec![(0.0, false)];
    let mut until = |end_s: f64, step_s: f64, rests: bool| {
        let (begin_s, _) = times[times.len() - 1];
        let count = ((end_s - begin_s) / step_s).ceil().max(0.0) as usize;
        if let Some(last) = times.last_mut().filter(|_| count > 0) {
            last.1 |= rests;
        }
        times.extend((1..=count).map(|index| (begin_s + (end_s - begin_s) * index as f64 / count as f64, rests)));
    };
    for phase in &plan.phases {
        let (begin_s, end_s) = pause_s(phase);
        until((begin_s + SETTLING_S).min(end_s), moving_s, false);
        until(end_s, resting_s, true);
    }
    if times.len() < 2 {
        times.push((MOVING_S, false));
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;
    use softlimb_scene as scene;
    use softlimb_scene::Scene;

    fn scene() -> Scene {
        scene::parse(include_str!("../../../../scenes/single-bending.toml"), "scene.toml").unwrap()
    }

    #[test]
    fn straight_lines_between_the_instants_of_a_pause_are_found_as_they_are() {
        let scene = scene();
        let model = Prepared::by_model(&scene).unwrap();
        let learner = Learner::new(&model, Camera::learning(&scene, 0.0, (1, 1))).unwrap();
        let times = &learner.corrections().times_s;
        // Up and down from instant to instant in pauses, which a mean around each would flatten; in moves something else.
        let height = |index: usize| if index.is_multiple_of(2) { 1e-3 } else { -2e-3 };
        let error = |time_s: f64| {
            let after = times.partition_point(|time| *time <= time_s).clamp(1, times.len() - 1);
            let share = (time_s - times[after - 1]) / (times[after] - times[after - 1]);
            let rests = learner.resting[after - 1] && learner.resting[after];
            Vector3::z() * if rests { height(after - 1) * (1.0 - share) + height(after) * share } else { 0.1 }
        };
        let end_ms = (times[times.len() - 1] * 1e3) as u32;
        let observations: Vec<_> =
            (0..end_ms).step_by(20).map(|ms| f64::from(ms) * 1e-3).map(|s| (s, error(s))).collect();
        let found = learner.errors(&observations);
        for (index, found) in found.iter().enumerate() {
            let wanted = if learner.resting[index] { height(index) } else { 0.1 };
            assert!((found.unwrap() - Vector3::z() * wanted).norm() < 1e-12, "{index}: {found:?}");
        }
        // One observation tells about one instant, none about none.
        let one = learner.errors(&observations[..1]);
        assert_eq!(one.iter().flatten().count(), 1);
        assert!(learner.errors(&[]).iter().all(Option::is_none));
    }

    #[test]
    fn pause_has_instants_of_its_own() {
        let scene = scene();
        let instants = instants(Prepared::by_model(&scene).unwrap().plan(), 0.0);
        assert!(instants.is_sorted_by(|(a, _), (b, _)| a < b));
        // Moves of 1.5 s and pauses of 1 s.
        for (time_s, rests) in instants {
            let into_phase_s = time_s % 2.5;
            let is_end = time_s > 0.0 && !(1e-6..2.5 - 1e-6).contains(&into_phase_s);
            assert_eq!(rests, is_end || into_phase_s > 1.8 - 1e-6, "{time_s} s");
        }
    }
}
