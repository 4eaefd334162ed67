//! Observes a channel by the model: the pressure that the coil times should have made, beside the reading.
//!
//! Between two readings the expected pressure changes by the modelled flow through the valves, times a gain per direction that is learned
//! while both agree. The expectation follows the reading slowly: leaks, creep and heat move a sound chamber by less than that. A reading
//! that leaves the expectation further than the model is wrong names the part that explains it.

use crate::gas::Chamber;
use crate::pneumatics::Pneumatics;
use crate::sensor::AdcCode;
use crate::valve::{Direction, TICK_US, ValvePulse};

/// Distance below and above the expectation that a sound channel keeps, Pa. A reading that is too low is the dangerous one: the loop would fill.
const BELOW_PA: f32 = 6_000.0;
const ABOVE_PA: f32 = 10_000.0;

/// Error of the modelled effect as a share of it: before a gain is learned, and after.
const ERROR_START: f32 = 0.6;
const ERROR_LEARNED: f32 = 0.2;

/// Effect after which a gain counts as learned, Pa.
const LEARNED_PA: f32 = 60_000.0;

/// Time after which an effect has lost `1 - 1/e` of its weight, s: heat is exchanged by then.
const EFFECT_MEMORY_S: f32 = 1.0;

/// Rate at which a sound chamber changes by itself, Pa/s: a leak of 0.6 normal mL/s in 80 mL.
const SELF_PA_PER_S: f32 = 600.0;

/// Bounds of a gain, its rate, and the effect at which it takes half of that, Pa.
const GAIN_MIN: f32 = 0.4;
const GAIN_MAX: f32 = 2.5;
const GAIN_RATE: f32 = 0.3;
const GAIN_NOISE_PA: f32 = 3_000.0;

/// Ticks in a row that a finding has to last.
const TICKS: u8 = 3;

/// Effect without any change of the code that tells a frozen sensor, Pa: noise alone moves the code of a sound one.
const FROZEN_PA: f32 = 3_000.0;

/// Change within the ticks of a finding that no valve makes, Pa.
const JUMP_PA: f32 = 4_000.0;

const TICK_S: f32 = TICK_US as f32 * 1e-6;

/// Part that explains a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Finding {
    /// The code does not change while air flows.
    Frozen,
    /// The reading changed faster than any valve could make it.
    Jumped,
    /// Filling does not raise the reading.
    FillWithoutEffect,
    /// Venting does not lower it.
    VentWithoutEffect,
    /// It changes against the open valve.
    Reversed,
    /// It rises without filling.
    RiseWithoutFill,
    /// It falls without venting.
    FallWithoutVent,
}

/// One valve as its coil makes it move.
#[derive(Clone, Copy, Debug)]
struct Poppet {
    opens_at_us: u64,
    closes_at_us: u64,
    is_energized: bool,
}

impl Poppet {
    const CLOSED: Self = Self { opens_at_us: u64::MAX, closes_at_us: 0, is_energized: false };

    /// Takes the coil time of the tick that begins at `now_us`.
    fn drive(&mut self, now_us: u64, coil_us: u16, pneumatics: &Pneumatics) {
        if coil_us > 0 && !self.is_energized {
            let is_open = self.closes_at_us > now_us && self.opens_at_us <= now_us;
            if !is_open {
                self.opens_at_us = now_us + u64::from(pneumatics.timing.on_delay_us);
            }
        }
        if coil_us > 0 {
            self.closes_at_us = now_us + u64::from(coil_us) + u64::from(pneumatics.timing.off_delay_us);
        }
        self.is_energized = u32::from(coil_us) == TICK_US;
        let coil_off_us = now_us + u64::from(coil_us);
        if !self.is_energized && self.opens_at_us > coil_off_us {
            // Switched off within the opening delay: it never opens.
            self.opens_at_us = u64::MAX;
        }
    }

    /// Time within the tick before `now_us` for which the valve was open, s.
    fn open_s(&self, now_us: u64) -> f32 {
        let begin = self.opens_at_us.max(now_us.saturating_sub(u64::from(TICK_US)));
        let end = self.closes_at_us.min(now_us);
        end.saturating_sub(begin).min(u64::from(TICK_US)) as f32 * 1e-6
    }
}

/// Gain of one direction.
#[derive(Clone, Copy, Debug)]
struct Gain {
    value: f32,
    /// Effect it was learned from, Pa, up to [`LEARNED_PA`].
    seen_pa: f32,
}

impl Gain {
    const UNKNOWN: Self = Self { value: 1.0, seen_pa: 0.0 };

    fn error(&self) -> f32 {
        ERROR_START + (ERROR_LEARNED - ERROR_START) * (self.seen_pa / LEARNED_PA)
    }

    /// Learns from a modelled effect, signed, that was `missed_pa` short of the measured one.
    fn learn(&mut self, effect_pa: f32, missed_pa: f32) {
        let step = GAIN_RATE * missed_pa * effect_pa / (effect_pa * effect_pa + GAIN_NOISE_PA * GAIN_NOISE_PA);
        self.value = (self.value + step).clamp(GAIN_MIN, GAIN_MAX);
        self.seen_pa = (self.seen_pa + effect_pa.abs()).min(LEARNED_PA);
    }
}

/// Inputs of one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation<'a> {
    pub(crate) now_us: u64,
    pub(crate) code: AdcCode,
    pub(crate) reading_pa: f32,
    pub(crate) supply_pa: f32,
    /// The air of the line still moves.
    pub(crate) is_line_moving: bool,
    /// Largest drop between manifold and chamber by the model, Pa.
    pub(crate) line_drop_pa: f32,
    pub(crate) chamber: &'a Chamber,
    pub(crate) pneumatics: &'a Pneumatics,
}
