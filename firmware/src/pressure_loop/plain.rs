//! Plain loops, to compare the predicted pulses with: a PI controller with feed-forward, and valves that are on or off.
//!
//! Neither adapts to its valves and its chamber, and neither has a balance of the air.

use super::{LoopInput, PressureLoop};
use crate::reference::Reference;
use crate::valve::{Direction, TICK_US};

/// Gains of the PI controller, 1/s and 1/s2.
const PROPORTIONAL_PER_S: f32 = 15.0;
const INTEGRAL_PER_S2: f32 = 20.0;

/// Coil time beyond the opening delay of a shortest pulse, us: valves whose delay is 30 % longer open too.
const MARGIN_US: u32 = 1_500;

/// Smallest rate that a valve is credited with, Pa/s.
const RATE_MIN_PA_PER_S: f32 = 500.0;

/// Error up to which the on-off loop keeps the valves closed, Pa.
const DEAD_BAND_PA: f32 = 1e3;

impl PressureLoop {
    /// Sets the coils for one control period. The wanted rate is that of the reference, plus proportional and integral action on the error; the
    /// inverse of the flow through valve and line turns it into a time. The integral is kept as the drift that it makes up for.
    pub fn decide_proportional_integral(&mut self, input: &LoopInput, reference: &Reference) {
        self.forget_pulse();
        let sample = self.sample_kind(input.now_us);
        let pressure_pa = input.sensor_pa - self.modelled_drop_pa(input, sample);
        let period_s = reference.period_us as f32 * 1e-6;
        let error_pa = reference.at(input.now_us) - pressure_pa;
        let ahead_pa_per_s = (reference.end_pa - reference.start_pa) / period_s;
        let rate_pa_per_s = ahead_pa_per_s + PROPORTIONAL_PER_S * error_pa - self.adaptation.drift_pa_per_s();
        let direction = if rate_pa_per_s >= 0.0 { Direction::Fill } else { Direction::Vent };
        let most_pa_per_s =
            input.pneumatics.rate_pa_per_s(direction, input.chamber, pressure_pa, input.supply_pa).abs();
        let share = rate_pa_per_s.abs() / most_pa_per_s.max(RATE_MIN_PA_PER_S);
        // A valve that is open for all of the period can do no more: the integral waits.
        if share < 1.0 {
            self.adaptation.integrate(INTEGRAL_PER_S2 * period_s * error_pa);
        }
        let timing = input.pneumatics.timing;
        let open_us = (share.min(1.0) * reference.period_us as f32) as u32;
        let coil_us = if sample.direction() == Some(direction) {
            timing.coil_rest_us(open_us)
        } else if 2 * open_us < timing.shortest_open_us(MARGIN_US) {
            0
        } else {
            timing.coil_us(open_us, MARGIN_US)
        };
        match coil_us {
            0 => self.valves.close(input.now_us),
            _ => self.valves.pulse(direction, input.now_us, coil_us.min(reference.period_us)),
        }
    }

    /// Sets the coils for the tick that begins now: on while the reading of the manifold is beyond the dead band, even while air flows.
    pub fn decide_on_off(&mut self, now_us: u64, sensor_pa: f32, reference: &Reference) {
        self.forget_pulse();
        let error_pa = reference.at(now_us) - sensor_pa;
        if error_pa.abs() <= DEAD_BAND_PA {
            self.valves.close(now_us);
            return;
        }
        let direction = if error_pa > 0.0 { Direction::Fill } else { Direction::Vent };
        self.valves.pulse(direction, now_us, TICK_US);
    }

    /// The predicted pulses know nothing of what these loops do to the valves.
    fn forget_pulse(&mut self) {
        self.balance.interrupt();
        self.fine.restart();
        self.last = None;
    }
}
