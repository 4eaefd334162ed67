//! The pulse that brings a chamber to its target, by the flow through valve and line at present pressures.

use crate::pressure_loop::LoopInput;
use crate::valve::Direction;

/// Share of the shortest pulse's effect within which the error is left alone.
const DEADBAND: f32 = 0.55;

/// Smallest deadband, Pa: sensor noise.
const DEADBAND_MIN_PA: f32 = 120.0;

/// Smallest rate a valve is credited with, Pa/s: beyond it a pulse has no use.
const RATE_MIN_PA_PER_S: f32 = 500.0;

/// One period's coil time and its predicted effect.
pub(crate) struct Plan {
    pub(crate) direction: Option<Direction>,
    pub(crate) coil_us: u32,
    /// Pressure change at gain 1, Pa, signed.
    pub(crate) modelled_pa: f32,
}

impl Plan {
    /// Leaves the valves closed.
    pub(crate) const NOTHING: Self = Self { direction: None, coil_us: 0, modelled_pa: 0.0 };
}

/// The pulse that would bring the chamber from its pressure to the target.
pub(crate) struct PulseModel<'a> {
    pub(crate) input: &'a LoopInput<'a>,
    pub(crate) direction: Direction,
    /// Pressure of the chamber, Pa.
    pub(crate) pressure_pa: f32,
    /// Desired effect of the pulse, Pa, signed.
    pub(crate) change_pa: f32,
    /// Real over modelled effect.
    pub(crate) gain: f32,
    /// Coil time beyond the opening delay of a short pulse, us.
    pub(crate) margin_us: u32,
    /// Time to the end of the control period, us.
    pub(crate) rest_us: u32,
}

impl PulseModel<'_> {
    /// Magnitude of the rate at gain 1, Pa/s.
    fn rate_pa_per_s(&self, direction: Direction, pressure_pa: f32) -> f32 {
        let input = self.input;
        let rate = input.pneumatics.rate_pa_per_s(direction, input.chamber, pressure_pa, input.supply_pa);
        rate.abs().max(RATE_MIN_PA_PER_S)
    }

    /// Time the valve has to be open, us: by the rate halfway. At most 32 times the rest of the period: beyond, noise of the drift outweighs the
    /// error of a slow chamber, and would turn its valves away from the reference.
    pub(crate) fn open_time_us(&self) -> u32 {
        let halfway_pa = self.pressure_pa + 0.5 * self.change_pa;
        let rate = self.gain * self.rate_pa_per_s(self.direction, halfway_pa);
        // The cast saturates.
        ((self.change_pa.abs() / rate * 1e6) as u32).min(32 * self.rest_us)
    }

    /// Pressure change of an opening at gain 1, Pa, signed: by the rate halfway.
    fn effect_pa(&self, direction: Direction, open_us: u32) -> f32 {
        let time_s = open_us as f32 * 1e-6;
        let sign = if direction == Direction::Fill { 1.0 } else { -1.0 };
        let half = 0.5 * sign * self.rate_pa_per_s(direction, self.pressure_pa) * time_s;
        sign * self.rate_pa_per_s(direction, self.pressure_pa + half) * time_s
    }

    /// Effect of the shortest pulse, Pa.
    pub(crate) fn shortest_effect_pa(&self) -> f32 {
        let shortest_us = self.input.pneumatics.timing.shortest_open_us(self.margin_us);
        self.gain * self.effect_pa(self.direction, shortest_us).abs()
    }

    pub(crate) fn deadband_pa(&self) -> f32 {
        (DEADBAND * self.shortest_effect_pa()).max(DEADBAND_MIN_PA)
    }

    /// Coil time until the end of the period, from a closed valve or one that is open in the desired direction.
    pub(crate) fn plan(&self, is_open: bool) -> Plan {
        let timing = self.input.pneumatics.timing;
        let open_us = self.open_time_us().min(2 * self.rest_us);
        let coil_us = if is_open { timing.coil_rest_us(open_us) } else { timing.coil_us(open_us, self.margin_us) };
        let ends_open = coil_us >= self.rest_us;
        let coil_us = coil_us.min(self.rest_us);
        let opening_us = if is_open { 0 } else { timing.on_delay_us };
        let closing_us = if ends_open { 0 } else { timing.off_delay_us };
        Plan {
            direction: Some(self.direction),
            coil_us,
            modelled_pa: self.effect_pa(self.direction, (coil_us + closing_us).saturating_sub(opening_us)),
        }
    }

    /// Closes a valve that is open in `direction`.
    pub(crate) fn closing(&self, direction: Direction) -> Plan {
        Plan {
            direction: Some(direction),
            coil_us: 0,
            modelled_pa: self.effect_pa(direction, self.input.pneumatics.timing.off_delay_us),
        }
    }
}
