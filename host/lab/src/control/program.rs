//! The reference of a trial: ten steps, a sine, and a trajectory of a limb.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::faults::bench::KNOT_US;

/// Levels of the steps, Pa, from [`FIRST_PA`] on.
const LEVELS_PA: [f64; 10] = [100e3, 50e3, 60e3, 50e3, 20e3, 10e3, 60e3, 120e3, 80e3, 60e3];
const FIRST_PA: f64 = 5e3;

/// Begin of the steps and time of each, s.
pub(crate) const STEPS_S: f64 = 1.0;
pub(crate) const STEP_S: f64 = 1.8;

/// Share of a step within which its level counts as reached, and the least distance, Pa.
const NEAR: f64 = 0.02;
const NEAR_PA: f64 = 1e3;

/// Distance of a level from which on a step has reached it, Pa.
pub(crate) fn near_pa(from_pa: f64, to_pa: f64) -> f64 {
    NEAR_PA.max(NEAR * (to_pa - from_pa).abs())
}

/// The steps, from and to, Pa.
pub(crate) fn steps_pa() -> impl Iterator<Item = (f64, f64)> {
    std::iter::once(FIRST_PA).chain(LEVELS_PA).zip(LEVELS_PA)
}

/// The sine: begin, and the part that is judged, s; mean and amplitude, Pa; frequency, Hz.
const SINE_S: f64 = 19.5;
pub(crate) const SINE_JUDGED_S: Range<f64> = 20.5..24.5;
const SINE_MEAN_PA: f64 = 60e3;
const SINE_PA: f64 = 20e3;
const SINE_HZ: f64 = 1.0;

/// The trajectory: its judged part, s, and its levels, Pa, a second apart.
pub(crate) const TRAJECTORY_S: Range<f64> = 25.5..33.5;
const TRAJECTORY_PA: [f64; 9] = [60e3, 60e3, 110e3, 80e3, 80e3, 30e3, 5e3, 5e3, 60e3];

/// Largest change from one knot to the next, Pa: the device refuses references that cross 0 to 140 kPa in less than 0.1 s.
const CHANGE_PA: f64 = 27.9e3;

fn wanted_pa(time_s: f64) -> f64 {
    if time_s < STEPS_S {
        FIRST_PA
    } else if time_s < SINE_S {
        let index = ((time_s - STEPS_S) / STEP_S) as usize;
        LEVELS_PA[index.min(LEVELS_PA.len() - 1)]
    } else if time_s < SINE_JUDGED_S.end {
        SINE_MEAN_PA + SINE_PA * (TAU * SINE_HZ * (time_s - SINE_S)).sin()
    } else {
        trajectory_pa(time_s - TRAJECTORY_S.start)
    }
}

fn trajectory_pa(time_s: f64) -> f64 {
    let time_s = time_s.clamp(0.0, TRAJECTORY_S.end - TRAJECTORY_S.start);
    let index = (time_s as usize).min(TRAJECTORY_PA.len() - 2);
    let share = time_s - index as f64;
    let smooth = share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share);
    TRAJECTORY_PA[index] + smooth * (TRAJECTORY_PA[index + 1] - TRAJECTORY_PA[index])
}

/// End of the program, s.
pub(crate) fn end_s() -> f64 {
    TRAJECTORY_S.end
}

/// Reference at each knot, Pa.
pub(crate) fn knots_pa() -> Vec<f64> {
    let count = (TRAJECTORY_S.end * 1e6) as u64 / KNOT_US;
    let mut last_pa = FIRST_PA;
    let mut knot = |index: u64| {
        let time_s = (index * KNOT_US) as f64 * 1e-6;
        last_pa += (wanted_pa(time_s + 1e-9) - last_pa).clamp(-CHANGE_PA, CHANGE_PA);
        last_pa
    };
    (0..=count).map(&mut knot).collect()
}

/// Reference at a time, linear between knots, Pa.
pub(crate) fn reference_pa(knots_pa: &[f64], time_s: f64) -> f64 {
    let place = (time_s * 1e6 / KNOT_US as f64).clamp(0.0, (knots_pa.len() - 1) as f64);
    let index = (place as usize).min(knots_pa.len() - 2);
    knots_pa[index] + (place - index as f64) * (knots_pa[index + 1] - knots_pa[index])
}
