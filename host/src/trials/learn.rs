//! One limb's corrections, rehearsal by rehearsal.
//!
//! The tip is off by `e(t)`. Moving the setpoints of the modules by `du` moves the tip by `J du`, with the model's `J` at the planned pose, so
//! the corrections at instants along the run grow by the `du` that minimises `|J du + e|^2 + (r |du/range|)^2`: the second term, a length `r`,
//! leaves alone what hardly moves the tip. The first rehearsals are believed whole, later ones by the share that makes the corrections a
//! mean, because what the valves leave of a reference differs from run to run.

use nalgebra::{DMatrix, DVector, Vector3};

use super::score::{SETTLING_S, error_m, pause_s};
use crate::design::Limb;
use crate::design::fit::Random;
use crate::motion::{Corrections, Plan, tip_slopes};
use crate::record::Sample;

/// Time between instants of the corrections while the limb moves, and at most while it rests, s.
const MOVING_S: f64 = 0.1;
const RESTING_S: f64 = 0.5;
/// Tip motion by the whole range of a module that is hardly worth its while, m.
const HARDLY_M: f64 = 2e-3;
/// Rehearsals that are believed whole.
const WHOLE: u32 = 2;
/// Stream of the camera's noise.
const CAMERA: u64 = 1;

/// What is learned about one limb in one scene.
pub(super) struct Learner<'a> {
    limb: &'a Limb,
    plan: &'a Plan,
    corrections: Corrections,
    rehearsals: u32,
    camera_noise_m: f64,
    random: Random,
}

impl<'a> Learner<'a> {
    /// Nothing learned. `camera_noise_m` as in [`Settings`](super::Settings).
    pub(super) fn new(limb: &'a Limb, plan: &'a Plan, camera_noise_m: f64, seed: u64) -> Self {
        let modules = limb.modules().len();
        let times_s = instants(plan);
        let rows = vec![vec![0.0; modules]; times_s.len()];
        let corrections = Corrections { times_s, rows };
        Self { limb, plan, corrections, rehearsals: 0, camera_noise_m, random: Random::new(seed, CAMERA) }
    }

    /// What was learned.
    pub(super) fn corrections(&self) -> &Corrections {
        &self.corrections
    }

    /// Learns from a rehearsal with the present corrections; the error at rest as the camera saw it, RMS, m.
    pub(super) fn learn(&mut self, samples: &[Sample]) -> f64 {
        self.rehearsals += 1;
        let end_s = self.plan.duration_us() as f64 * 1e-6;
        let looks: Vec<(f64, Vector3<f64>)> = samples
            .iter()
            .filter(|sample| sample.time_s <= end_s)
            .filter_map(|sample| Some((sample.time_s, error_m(sample, sample.tip_achieved_m?))))
            .map(|(time_s, error)| (time_s, error + self.noise()))
            .collect();
        let mut sums = vec![(Vector3::zeros(), 0.0); self.corrections.times_s.len()];
        looks.iter().for_each(|(time_s, error)| self.share(*time_s, *error, &mut sums));
        self.correct(&sums);
        let rests: Vec<_> = self.plan.phases.iter().map(pause_s).collect();
        let is_rest = |time_s: f64| rests.iter().any(|(begin, end)| time_s > begin + SETTLING_S && time_s <= *end);
        let seen = looks.iter().filter(|(time_s, _)| is_rest(*time_s)).map(|(_, error)| error.norm_squared());
        let (sum, count) = seen.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }

    /// Noise of one look, m: of nearly normal distribution.
    fn noise(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let sum: f64 = (0..12).map(|_| self.random.uniform()).sum();
            self.camera_noise_m * (sum - 6.0)
        })
    }

    /// Gives an error to the instants on both sides of its time.
    fn share(&self, time_s: f64, error: Vector3<f64>, sums: &mut [(Vector3<f64>, f64)]) {
        let times = &self.corrections.times_s;
        let after = times.partition_point(|time| *time <= time_s).clamp(1, times.len() - 1);
        let share = ((time_s - times[after - 1]) / (times[after] - times[after - 1])).clamp(0.0, 1.0);
        for (index, weight) in [(after - 1, 1.0 - share), (after, share)] {
            sums[index].0 += error * weight;
            sums[index].1 += weight;
        }
    }

    fn correct(&mut self, sums: &[(Vector3<f64>, f64)]) {
        let gain = 1.0 / f64::from(self.rehearsals.saturating_sub(WHOLE - 1).max(1));
        let ranges: Vec<(f64, f64)> = self.limb.modules().iter().map(|module| module.range()).collect();
        for (index, (sum, weight)) in sums.iter().enumerate().filter(|(_, (_, weight))| *weight > 0.0) {
            let time_us = self.corrections.times_s[index] * 1e6;
            let slopes = tip_slopes(self.limb, &self.plan.states_at(time_us));
            let steps = step(&slopes, &ranges, &(sum / *weight));
            let planned = self.plan.values_at(time_us);
            for (module, value) in self.corrections.rows[index].iter_mut().enumerate() {
                let (rest, last) = ranges[module];
                // What is out of reach is not asked for more and more.
                let wanted = planned[module] + *value + gain * steps[module];
                *value = wanted.clamp(rest.min(last), rest.max(last)) - planned[module];
            }
        }
    }
}

/// The change of the setpoints that takes an error of the tip away, m.
fn step(slopes: &[(Vector3<f64>, f64)], ranges: &[(f64, f64)], error: &Vector3<f64>) -> Vec<f64> {
    let count = slopes.len();
    let widths: Vec<f64> = ranges.iter().map(|(rest, last)| (last - rest).abs()).collect();
    let mut matrix = DMatrix::zeros(3 + count, count);
    for (column, ((velocity, slope), width)) in slopes.iter().zip(&widths).enumerate() {
        let whole = if *slope == 0.0 { Vector3::zeros() } else { velocity * (width / slope) };
        matrix.fixed_view_mut::<3, 1>(0, column).copy_from(&whole);
        matrix[(3 + column, column)] = HARDLY_M;
    }
    let mut wanted = DVector::zeros(3 + count);
    wanted.fixed_rows_mut::<3>(0).copy_from(&-error);
    // Of full rank by its lower half.
    let shares = matrix.svd(true, true).solve(&wanted, 0.0).unwrap_or_else(|_| DVector::zeros(count));
    shares.iter().zip(&widths).map(|(share, width)| share * width).collect()
}

/// Instants of the corrections, s: rising, from the start to the end, two at least.
fn instants(plan: &Plan) -> Vec<f64> {
    let mut times = vec![0.0];
    let mut until = |end_s: f64, step_s: f64| {
        let begin_s = times[times.len() - 1];
        let count = ((end_s - begin_s) / step_s).ceil().max(0.0) as usize;
        times.extend((1..=count).map(|index| begin_s + (end_s - begin_s) * index as f64 / count as f64));
    };
    for phase in &plan.phases {
        let (begin_s, end_s) = pause_s(phase);
        until((begin_s + SETTLING_S).min(end_s), MOVING_S);
        until(end_s, RESTING_S);
    }
    until(plan.duration_us() as f64 * 1e-6, MOVING_S);
    if times.len() < 2 {
        times.push(MOVING_S);
    }
    times
}
