//! Figures of one channel in one trial.

use std::ops::Range;

use softlimb_numerics::statistics::{percentile, root_mean_square};

use super::bench::Recording;
use super::limits::Limits;
use super::program::{SINE_JUDGED_S, STEP_S, STEPS_S, TRAJECTORY_S, knots_pa, near_pa, reference_pa, steps_pa};
use crate::faults::bench::{CHANNELS, KNOT_US};

/// Part of a step, from its end, in which the pressure is steady, s.
const STEADY_S: f64 = 0.6;

/// Time by which the loop leaves for the next step before its reference, at most: it aims a control period ahead, s.
const AHEAD_S: f64 = 0.04;

/// Figures of one channel. Errors are true pressure minus reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Time to settle over the time of a valve that is left open: median and greatest of the steps.
    pub settle: [f64; 2],
    /// Largest pressure beyond the level of a step, Pa.
    pub overshoot_pa: f64,
    /// RMS error at the end of the steps, Pa.
    pub steady_pa: f64,
    /// RMS error of the sine, Pa, and over that of equal pulses as frequent.
    pub sine_pa: f64,
    /// See `sine_pa`.
    pub sine_ratio: f64,
    /// RMS and greatest error of the trajectory, Pa.
    pub trajectory_pa: [f64; 2],
    /// Openings and closings of both valves in the trajectory, 1/s.
    pub switchings_per_s: f64,
    /// Air taken in the trajectory over the air that its reference takes.
    pub air_ratio: f64,
    /// Rise of the pressure by the shortest pulse of the fill valve, Pa.
    pub pulse_pa: f64,
}

impl Figures {
    /// All figures, in the order of the table.
    #[must_use]
    pub fn values(&self) -> [f64; 11] {
        let [median, greatest] = self.settle;
        let [rms_pa, most_pa] = self.trajectory_pa;
        let Self { overshoot_pa, steady_pa, sine_pa, sine_ratio, switchings_per_s, air_ratio, pulse_pa, .. } = *self;
        let steps = [median, greatest, overshoot_pa, steady_pa];
        let moves = [sine_pa, sine_ratio, rms_pa, most_pa, switchings_per_s, air_ratio, pulse_pa];
        std::array::from_fn(|index| if index < steps.len() { steps[index] } else { moves[index - steps.len()] })
    }
}

/// The figures of all channels beside the limits of the plant.
pub(super) fn of(recording: &Recording, limits: &Limits) -> Vec<Figures> {
    let knots_pa = knots_pa();
    (0..CHANNELS).map(|channel| Track { recording, knots_pa: &knots_pa, channel }.figures(limits)).collect()
}

/// One channel of a recording.
struct Track<'a> {
    recording: &'a Recording,
    knots_pa: &'a [f64],
    channel: usize,
}

impl Track<'_> {
    fn figures(&self, limits: &Limits) -> Figures {
        let steps: Vec<_> = steps_pa().enumerate().collect();
        let ratios: Vec<f64> = steps
            .iter()
            .map(|(index, (from_pa, to_pa))| {
                self.settled_s(*index, *from_pa, *to_pa) / limits.settle_s[*index][self.channel]
            })
            .collect();
        let overshoot_pa = steps
            .iter()
            .map(|(index, (from_pa, to_pa))| self.overshoot_pa(*index, *from_pa, *to_pa))
            .fold(0.0, f64::max);
        let steady = steps.iter().flat_map(|(index, _)| {
            let end_s = STEPS_S + STEP_S * (index + 1) as f64;
            self.errors_pa(end_s - STEADY_S..end_s - KNOT_US as f64 * 1e-6 - AHEAD_S)
        });
        let sine_pa = rms(self.errors_pa(SINE_JUDGED_S));
        let trajectory_pa =
            [rms(self.errors_pa(TRAJECTORY_S)), self.errors_pa(TRAJECTORY_S).map(f64::abs).fold(0.0, f64::max)];
        Figures {
            settle: [
                percentile(ratios.iter().copied(), 50).unwrap_or(f64::NAN),
                ratios.iter().copied().fold(0.0, f64::max),
            ],
            overshoot_pa,
            steady_pa: rms(steady),
            sine_pa,
            sine_ratio: sine_pa / self.quantisation_pa(SINE_JUDGED_S),
            trajectory_pa,
            switchings_per_s: self.switchings_per_s(TRAJECTORY_S),
            air_ratio: self.air_ratio(limits),
            pulse_pa: limits.pulse_pa[self.channel],
        }
    }

    /// Air taken in the trajectory, less what the chamber holds more at its end than at its start, over the air by which the reference
    /// fills it.
    fn air_ratio(&self, limits: &Limits) -> f64 {
        let moments = || self.recording.moments.iter().filter(|moment| TRAJECTORY_S.contains(&moment.time_s));
        let (Some(first), Some(last)) = (moments().next(), moments().next_back()) else { return f64::NAN };
        let holds_kg = |pressure_pa: f64| limits.air_kg(self.channel, pressure_pa);
        let [before_kg, after_kg] = [first, last].map(|moment| holds_kg(moment.pressure_pa[self.channel]));
        let taken_kg = last.air_kg[self.channel] - first.air_kg[self.channel];
        let knot_s = KNOT_US as f64 * 1e-6;
        let count = ((TRAJECTORY_S.end - TRAJECTORY_S.start) / knot_s).round() as usize;
        let at_knot = |index: usize| reference_pa(self.knots_pa, TRAJECTORY_S.start + knot_s * index as f64);
        let held_kg: Vec<f64> = (0..=count).map(|index| holds_kg(at_knot(index))).collect();
        let needed_kg: f64 = held_kg.windows(2).map(|pair| (pair[1] - pair[0]).max(0.0)).sum();
        (taken_kg - (after_kg - before_kg)) / needed_kg
    }

    /// Times and pressures of a part, s and Pa.
    fn part(&self, span_s: Range<f64>) -> impl Iterator<Item = (f64, f64)> {
        let moments = self.recording.moments.iter().filter(move |moment| span_s.contains(&moment.time_s));
        moments.map(|moment| (moment.time_s, moment.pressure_pa[self.channel]))
    }

    fn errors_pa(&self, span_s: Range<f64>) -> impl Iterator<Item = f64> {
        self.part(span_s).map(|(time_s, pressure_pa)| pressure_pa - reference_pa(self.knots_pa, time_s))
    }

    /// The part of a step until the loop leaves for the next one. The reference leaves with the last knot before.
    fn step(&self, index: usize) -> impl Iterator<Item = (f64, f64)> {
        let begin_s = STEPS_S + STEP_S * index as f64 - KNOT_US as f64 * 1e-6;
        let part = self.part(begin_s..begin_s + STEP_S - AHEAD_S);
        part.map(move |(time_s, pressure_pa)| (time_s - begin_s, pressure_pa))
    }

    /// Time after which the pressure stays near to the level, s.
    fn settled_s(&self, index: usize, from_pa: f64, to_pa: f64) -> f64 {
        let near_pa = near_pa(from_pa, to_pa);
        let off = self.step(index).filter(|(_, pressure_pa)| (pressure_pa - to_pa).abs() > near_pa);
        off.map(|(time_s, _)| time_s).last().unwrap_or(0.0)
    }

    fn overshoot_pa(&self, index: usize, from_pa: f64, to_pa: f64) -> f64 {
        let direction = (to_pa - from_pa).signum();
        self.step(index).map(|(_, pressure_pa)| direction * (pressure_pa - to_pa)).fold(0.0, f64::max)
    }

    fn switchings_per_s(&self, span_s: Range<f64>) -> f64 {
        let seconds = span_s.end - span_s.start;
        let moments: Vec<_> = self.recording.moments.iter().filter(|it| span_s.contains(&it.time_s)).collect();
        let edges = moments.windows(2).map(|pair| {
            let [before, after] = [pair[0], pair[1]].map(|moment| moment.open[self.channel]);
            before.iter().zip(after).filter(|(before, after)| **before != *after).count()
        });
        edges.sum::<usize>() as f64 / seconds
    }

    /// RMS error that equal pulses as frequent as these leave: each leaves a ramp as long as the time to the next.
    fn quantisation_pa(&self, span_s: Range<f64>) -> f64 {
        let pulses_per_s = 0.5 * self.switchings_per_s(span_s.clone());
        let changes = self.part(span_s).map(|(time_s, _)| {
            let knot_s = KNOT_US as f64 * 1e-6;
            (reference_pa(self.knots_pa, time_s + knot_s) - reference_pa(self.knots_pa, time_s)) / knot_s
        });
        rms(changes) / pulses_per_s / 12f64.sqrt()
    }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    root_mean_square(values).unwrap_or(f64::NAN)
}
