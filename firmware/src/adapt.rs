//! Adaptation of the loop to its channel: one gain per direction and a slow drift.

use crate::valve::Direction;

/// Bounds of a gain: real effect over modelled effect.
const GAIN_MIN: f32 = 0.3;
const GAIN_MAX: f32 = 3.0;

/// Share of an innovation that the gain takes at once, for effects well above the noise.
const GAIN_RATE: f32 = 0.3;

/// Effect at which the gain takes half that share, Pa: sensor noise and valve jitter hide smaller effects.
const GAIN_NOISE_PA: f32 = 700.0;

/// Share of an innovation rate that the drift takes.
const DRIFT_RATE: f32 = 0.25;

/// Largest drift believed, Pa/s: leaks, heat, and the motion of the limb.
const DRIFT_MAX_PA_PER_S: f32 = 40_000.0;

/// Time after which an estimate of the drift that nothing confirms has lost `1 - 1/e` of its value, s.
const DRIFT_MEMORY_S: f32 = 0.3;

/// Coil time beyond the opening delay that a short pulse has, us: to begin with, and at most. The delay is not exactly known.
const MARGIN_START_US: u32 = 500;
const MARGIN_MAX_US: u32 = 3_000;

/// Change of the margin by a pulse without effect (up) and by one with effect (down), us.
const MARGIN_UP_US: u32 = 250;
const MARGIN_DOWN_US: u32 = 10;

/// Share of the expected effect below which a pulse counts as not having opened the valve.
const NO_EFFECT: f32 = 0.25;

/// Smallest expected effect by which that is judged, Pa, and in multiples of the channel's mean residual.
const JUDGED_EFFECT_PA: f32 = 300.0;
const JUDGED_RESIDUAL: f32 = 3.0;

/// Pressure drop along the line, actual over modelled: to begin with, and bounds. A drop that is taken for too small closes a valve early,
/// one that is taken for too large closes it beyond the reference.
const DROP_START: f32 = 0.8;
const DROP_MIN: f32 = 0.3;
const DROP_MAX: f32 = 1.0;

/// Share of an innovation that the drop takes, and share of a pulse's effect that the model of the pulse may miss.
const DROP_RATE: f32 = 0.7;
const DROP_NOISE: f32 = 0.3;

/// Share of an innovation that the residual takes.
const RESIDUAL_RATE: f32 = 0.1;

/// Estimates of one valve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Learned {
    gain: f32,
    margin_us: u32,
    drop: f32,
}

impl Learned {
    const NOTHING: Self = Self { gain: 1.0, margin_us: MARGIN_START_US, drop: DROP_START };

    /// `innovation_pa` is the effect of the pulse beyond `expected_pa`; both signed. False if the pulse did not open the valve.
    fn learn(&mut self, effect: &Effect, expected_pa: f32, innovation_pa: f32, residual_pa: f32) -> bool {
        let judged = expected_pa.abs() > JUDGED_EFFECT_PA.max(JUDGED_RESIDUAL * residual_pa);
        let missing = judged && innovation_pa / expected_pa < NO_EFFECT - 1.0;
        if effect.coil_beyond_delay_us < MARGIN_MAX_US {
            if missing {
                self.margin_us = (self.margin_us + MARGIN_UP_US).min(MARGIN_MAX_US);
                return false;
            }
            self.margin_us = self.margin_us.saturating_sub(MARGIN_DOWN_US).max(MARGIN_START_US);
        }
        let size = effect.modelled_pa;
        let step = GAIN_RATE * innovation_pa * size / (size * size + GAIN_NOISE_PA * GAIN_NOISE_PA);
        self.gain = (self.gain + step).clamp(GAIN_MIN, GAIN_MAX);
        true
    }
}

/// Estimates of one channel: a gain and a margin of each valve, and the drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptation {
    fill: Learned,
    vent: Learned,
    drift_pa_per_s: f32,
    /// Mean size of the innovations, Pa: the disturbance of the channel from outside.
    residual_pa: f32,
}

/// Measured effect of one control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Direction of the pulse, if there was one.
    pub pulse: Option<Direction>,
    /// Coil time beyond the opening delay, us.
    pub coil_beyond_delay_us: u32,
    /// Pressure change that the flow model expects of the pulse at gain 1, Pa, signed.
    pub modelled_pa: f32,
    /// Pressure change measured, Pa.
    pub measured_pa: f32,
    /// Time over which it was measured, s, > 0.
    pub duration_s: f32,
}

impl Adaptation {
    /// Nothing learned: gains 1, no drift.
    pub const fn new() -> Self {
        Self { fill: Learned::NOTHING, vent: Learned::NOTHING, drift_pa_per_s: 0.0, residual_pa: 0.0 }
    }

    /// Real over modelled effect of a pulse, `0.3..=3`.
    pub fn gain(&self, direction: Direction) -> f32 {
        self.learned(direction).gain
    }

    /// Coil time beyond the opening delay that surely opens the valve, us.
    pub fn margin_us(&self, direction: Direction) -> u32 {
        self.learned(direction).margin_us
    }

    /// Actual over modelled drop of the pressure along the line behind the open valve, `0.3..=1`.
    pub fn line_drop(&self, direction: Direction) -> f32 {
        self.learned(direction).drop
    }

    /// Learns the drop from the first settled reading after a steady flow, which lies `innovation_pa` beyond its prediction.
    /// `drop_pa` is the modelled drop, `effect_pa` the expected effect of the rest of the pulse; all Pa, signed.
    pub(crate) fn learn_drop(&mut self, direction: Direction, drop_pa: f32, effect_pa: f32, innovation_pa: f32) {
        let missed_pa = DROP_NOISE * effect_pa;
        let noise = GAIN_NOISE_PA * GAIN_NOISE_PA + missed_pa * missed_pa;
        let step = DROP_RATE * innovation_pa * drop_pa / (drop_pa * drop_pa + noise);
        let learned = self.learned_mut(direction);
        learned.drop = (learned.drop - step).clamp(DROP_MIN, DROP_MAX);
    }

    /// Pressure change without any pulse, Pa/s.
    pub fn drift_pa_per_s(&self) -> f32 {
        self.drift_pa_per_s
    }

    /// Learns from one period: a normalized gradient step on gain and drift. A short pulse without effect did not open the
    /// valve, which says nothing about gain and drift.
    pub fn learn(&mut self, effect: &Effect) {
        let gain = effect.pulse.map_or(0.0, |direction| self.gain(direction));
        let expected_pa = gain * effect.modelled_pa;
        let innovation_pa = effect.measured_pa - expected_pa - self.drift_pa_per_s * effect.duration_s;
        let opened = match effect.pulse {
            Some(Direction::Fill) => self.fill.learn(effect, expected_pa, innovation_pa, self.residual_pa),
            Some(Direction::Vent) => self.vent.learn(effect, expected_pa, innovation_pa, self.residual_pa),
            None => true,
        };
        if opened {
            self.residual_pa += RESIDUAL_RATE * (innovation_pa.abs() - self.residual_pa);
            self.learn_drift(effect, innovation_pa);
        }
    }

    /// Adds integral action, Pa/s, to the drift with the opposite sign: a pressure that falls short counts as a negative drift.
    pub(crate) fn integrate(&mut self, lacking_pa_per_s: f32) {
        let drift = self.drift_pa_per_s - lacking_pa_per_s;
        self.drift_pa_per_s = drift.clamp(-DRIFT_MAX_PA_PER_S, DRIFT_MAX_PA_PER_S);
    }

    /// A short pulse has not opened its valve.
    pub(crate) fn missed(&mut self, direction: Direction) {
        let learned = self.learned_mut(direction);
        learned.margin_us = (learned.margin_us + MARGIN_UP_US).min(MARGIN_MAX_US);
    }

    /// A large pulse updates the gain, a small one or none the drift.
    fn learn_drift(&mut self, effect: &Effect, innovation_pa: f32) {
        let noise = GAIN_NOISE_PA * GAIN_NOISE_PA;
        let trust = noise / (effect.modelled_pa * effect.modelled_pa + noise);
        let forgotten = (effect.duration_s / DRIFT_MEMORY_S).min(1.0) * self.drift_pa_per_s * (1.0 - trust);
        let drift = self.drift_pa_per_s - forgotten + DRIFT_RATE * trust * innovation_pa / effect.duration_s;
        self.drift_pa_per_s = drift.clamp(-DRIFT_MAX_PA_PER_S, DRIFT_MAX_PA_PER_S);
    }

    fn learned_mut(&mut self, direction: Direction) -> &mut Learned {
        match direction {
            Direction::Fill => &mut self.fill,
            Direction::Vent => &mut self.vent,
        }
    }

    fn learned(&self, direction: Direction) -> &Learned {
        match direction {
            Direction::Fill => &self.fill,
            Direction::Vent => &self.vent,
        }
    }
}

impl Default for Adaptation {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period(pulse: Option<Direction>, modelled_pa: f32, measured_pa: f32) -> Effect {
        Effect { pulse, coil_beyond_delay_us: 10_000, modelled_pa, measured_pa, duration_s: 0.02 }
    }

    #[test]
    fn gain_of_one_direction_converges_and_leaves_the_other() {
        let mut adaptation = Adaptation::new();
        for _ in 0..40 {
            adaptation.learn(&period(Some(Direction::Vent), -5_000.0, -3_500.0));
        }
        assert!((adaptation.gain(Direction::Vent) - 0.7).abs() < 0.01);
        assert_eq!(adaptation.gain(Direction::Fill), 1.0);
    }

    #[test]
    fn leak_seen_without_pulses_becomes_the_drift() {
        let mut adaptation = Adaptation::new();
        for _ in 0..40 {
            adaptation.learn(&period(None, 0.0, -60.0));
        }
        assert!((adaptation.drift_pa_per_s() + 3_000.0).abs() < 1.0);
    }

    #[test]
    fn valve_without_effect_drives_the_gain_to_its_bound_only() {
        let mut adaptation = Adaptation::new();
        for _ in 0..1_000 {
            adaptation.learn(&period(Some(Direction::Fill), 9_000.0, 0.0));
        }
        assert_eq!(adaptation.gain(Direction::Fill), 0.3);
        for _ in 0..1_000 {
            adaptation.learn(&period(Some(Direction::Fill), 1_000.0, 90_000.0));
        }
        assert_eq!(adaptation.gain(Direction::Fill), 3.0);
    }

    #[test]
    fn drop_of_one_direction_converges_within_its_bounds_and_small_ones_teach_nothing() {
        // A valve of 0.8 of its conductance drops 0.64 of the pressure; the next estimate is off by the rest of the error.
        let mut adaptation = Adaptation::new();
        for _ in 0..8 {
            let innovation_pa = (adaptation.line_drop(Direction::Fill) - 0.64) * 18e3;
            adaptation.learn_drop(Direction::Fill, 18e3, 2e3, innovation_pa);
        }
        assert!((adaptation.line_drop(Direction::Fill) - 0.64).abs() < 0.01);
        assert_eq!(adaptation.line_drop(Direction::Vent), 0.8);
        adaptation.learn_drop(Direction::Vent, -20.0, -2e3, 500.0);
        assert!((adaptation.line_drop(Direction::Vent) - 0.8).abs() < 0.01);
        for _ in 0..100 {
            adaptation.learn_drop(Direction::Vent, -18e3, -2e3, -18e3);
        }
        assert_eq!(adaptation.line_drop(Direction::Vent), 0.3);
    }

    #[test]
    fn short_pulses_without_effect_grow_longer_and_leave_the_gain() {
        let mut adaptation = Adaptation::new();
        let missed = Effect { coil_beyond_delay_us: 500, ..period(Some(Direction::Vent), -600.0, 0.0) };
        adaptation.learn(&missed);
        assert_eq!(adaptation.margin_us(Direction::Vent), 750);
        assert_eq!(adaptation.margin_us(Direction::Fill), 500);
        for _ in 0..100 {
            adaptation.learn(&missed);
        }
        assert_eq!(adaptation.margin_us(Direction::Vent), 3_000);
        assert_eq!(adaptation.gain(Direction::Vent), 1.0);
    }
}
