//! Pressure control by predicted pulses: once per control period, with the valves closed, decide for how long which valve opens.
//!
//! The pulse is computed from the pressure the chamber should have in the middle of the time it will then be left alone
//! (preview), the flow through valve and line at present pressures, and the chamber's volume and compliance. Gains per direction
//! and a drift are learned from what the last pulse did. A move that needs more than one period keeps the valve open.

mod plain;

use crate::adapt::{Adaptation, Effect};
use crate::air_balance::{AirBalance, EXCESS_PA, Measurement};
use crate::fine_regulation::{FineRegulation, Pair};
use crate::gas::Chamber;
use crate::pneumatics::Pneumatics;
use crate::pulse::{Plan, PulseModel};
use crate::reference::Reference;
use crate::valve::{Direction, ValvePair, ValveTiming};

/// Time after a valve has closed until the manifold reads the chamber's pressure, us: the line empties into the chamber. At least,
/// if the reading stands still then, and at most.
const SETTLE_MIN_US: u32 = 3_000;
const SETTLE_MAX_US: u32 = 9_000;

/// Change from one sample to the next below which a reading stands still, Pa: above the noise, below the end of a settling line.
const STILL_PA: f32 = 250.0;

/// Length of the pulses of a pair over the shortest one.
const BACK: f32 = 1.05;

/// Largest excess of a pair over the reference, Pa: a pressure that is settled stays within 1 kPa.
const ABOVE_PA: f32 = 900.0;

/// Difference between the settled reading after a steady flow and its prediction from which on the hose counts as kinked: a multiple of the modelled
/// drop, plus a pressure, Pa. Conductances that scatter by 20 % change the drop by less than half.
const HINDERED_DROPS: f32 = 3.0;
const HINDERED_PA: f32 = 6e3;

/// Largest swing of the reading after a short pulse in a sound line: a multiple of the modelled steady drop, plus a pressure, Pa. What exceeds
/// it is a finding, so it is no less than the limit of excess air.
const SWING_DROPS: f32 = 0.3;
const SWING_PA: f32 = EXCESS_PA;

/// Relative uncertainty of a valve's opening delay, and the largest relative uncertainty of a pulse's effect that results.
const DELAY_DOUBT: f32 = 0.1;
const DELAY_DOUBT_MAX: f32 = 0.5;

/// Supply pressure above that of the chamber, Pa: below it a fill valve may let air flow back, and the balance is interrupted.
const SUPPLY_MIN_PA: f32 = 5e3;

/// Inputs of one decision.
#[derive(Clone, Copy, Debug)]
pub struct LoopInput<'a> {
    /// Time of the sample, us.
    pub now_us: u64,
    /// Gauge pressure at the manifold, Pa; the last good one where the sensor is not trusted.
    pub sensor_pa: f32,
    /// Change of the reading from the last sample, Pa.
    pub sensor_step_pa: f32,
    /// Whether the sensor can be believed. Otherwise the pressure is reckoned from the pulses.
    pub sensor_trusted: bool,
    /// Gauge pressure of the supply, Pa.
    pub supply_pa: f32,
    /// Gauge pressure that is not to be exceeded, Pa.
    pub pressure_max_pa: f32,
    /// Whether the channel may take air; a ramp down only lets it out.
    pub may_fill: bool,
    /// Volume and compliance of the chamber.
    pub chamber: &'a Chamber,
    /// Air path.
    pub pneumatics: &'a Pneumatics,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Decision {
    at_us: u64,
    pressure_pa: f32,
    pulse: Option<Direction>,
    coil_us: u32,
    modelled_pa: f32,
    sample: Sample,
    /// Reading less settled pressure by the model, Pa, behind a steady flow.
    drop_pa: f32,
}

/// Meaning of the manifold's sample for the chamber at a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sample {
    /// The valves are closed and the line has settled: the pressure itself.
    Settled,
    /// A valve opened in the last period and the flow is not steady yet: nothing; the model has to do.
    Opening(Direction),
    /// A valve has been open for more than a period: the pressure behind a steady flow.
    Steady(Direction),
}

impl Sample {
    fn direction(self) -> Option<Direction> {
        match self {
            Self::Settled => None,
            Self::Opening(direction) | Self::Steady(direction) => Some(direction),
        }
    }
}

/// The loop of one channel: coils, last decision, estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureLoop {
    valves: ValvePair,
    adaptation: Adaptation,
    fine: FineRegulation,
    balance: AirBalance,
    last: Option<Decision>,
}

impl PressureLoop {
    /// Valves closed, nothing learned.
    pub const fn new() -> Self {
        Self {
            valves: ValvePair::new(),
            adaptation: Adaptation::new(),
            fine: FineRegulation::new(),
            balance: AirBalance::new(),
            last: None,
        }
    }

    /// The coils.
    pub fn valves_mut(&mut self) -> &mut ValvePair {
        &mut self.valves
    }

    /// Estimates of the channel.
    pub fn adaptation(&self) -> &Adaptation {
        &self.adaptation
    }

    /// Balance of the channel's air.
    pub fn balance(&self) -> &AirBalance {
        &self.balance
    }

    /// Begins a new balance of the air.
    pub(crate) fn restart_balance(&mut self) {
        self.balance = AirBalance::new();
    }

    /// Switches the coils off and forgets the last pulse, whose effect is cut short; keeps the estimates.
    pub fn close(&mut self, now_us: u64) {
        self.valves.close(now_us);
        self.balance.end();
        self.last = None;
    }

    /// Takes the reading of this tick and its change from the last one, Pa.
    pub fn sample(&mut self, now_us: u64, timing: ValveTiming, reading_pa: f32, step_pa: f32) {
        let settled = self.valves.direction_at(now_us).is_none() && !self.is_line_moving(now_us, timing);
        self.fine.sample(settled.then_some(reading_pa));
        if settled && step_pa.abs() < STILL_PA {
            self.balance.rest(reading_pa);
        }
    }

    /// Whether the sample of this tick is fit for a decision: valves closed and line settled, or open from the last period on.
    /// `step_pa` is the change of the reading from the last sample, Pa.
    pub fn is_due(&self, now_us: u64, timing: ValveTiming, step_pa: f32, reference: &Reference) -> bool {
        if self.fine.is_near(reference, now_us) && self.open_since_last(now_us).is_none() {
            return self.fine.mean_pa().is_some();
        }
        let closed_us = self.closed_for_us(now_us, timing);
        let still = step_pa.abs() < STILL_PA;
        let settled = closed_us >= SETTLE_MAX_US || (closed_us >= SETTLE_MIN_US && still);
        self.open_since_last(now_us).is_some() || settled
    }

    /// Whether air may still move in the line, so that the manifold does not read the chamber's pressure.
    pub fn is_line_moving(&self, now_us: u64, timing: ValveTiming) -> bool {
        self.closed_for_us(now_us, timing) < SETTLE_MAX_US
    }

    /// Time for which the line has been settled, us.
    fn settled_for_us(&self, now_us: u64, timing: ValveTiming) -> u32 {
        self.closed_for_us(now_us, timing).saturating_sub(SETTLE_MAX_US)
    }

    /// Time for which the valves have been closed, us.
    fn closed_for_us(&self, now_us: u64, timing: ValveTiming) -> u32 {
        let closed_at_us = self.valves.closed_at_us().saturating_add(u64::from(timing.off_delay_us));
        u32::try_from(now_us.saturating_sub(closed_at_us)).unwrap_or(u32::MAX)
    }

    /// Decides on one control period: learns from the last pulse and sets the coils.
    pub fn decide(&mut self, input: &LoopInput, reference: &Reference) {
        let sample = self.sample_kind(input.now_us);
        let fill = self.pulse_model(input, reference, input.sensor_pa, 0);
        self.fine.note_shortest(self.towards(Direction::Fill, &fill).shortest_effect_pa());
        let near = self.fine.is_near(reference, input.now_us);
        let modelled_drop_pa = self.modelled_drop_pa(input, sample);
        let resting = near && sample == Sample::Settled && input.sensor_trusted && input.may_fill;
        let pressure_pa = self.chamber_pressure_pa(input, sample, modelled_drop_pa, resting);
        let last_pulse = self.last.and_then(|last| last.pulse);
        let settles = sample == Sample::Settled && self.settles(input.sensor_step_pa, last_pulse);
        if let Some(last) = self.last.filter(|last| last.sample == Sample::Settled && sample == Sample::Settled)
            && let Some(direction) = last.pulse
        {
            let swing_pa = self.swing_pa(input, &last, direction, pressure_pa).filter(|_| settles);
            self.balance.swing(swing_pa);
        }
        let hindered_pa = self.learn(input, pressure_pa, sample);
        let is_falling = settles && last_pulse == Some(Direction::Fill);
        if !matches!(sample, Sample::Opening(_)) && input.sensor_trusted && (!settles || is_falling) {
            let drop_pa = if sample == Sample::Settled { 0.0 } else { input.sensor_pa - pressure_pa };
            let (now_us, step_pa) = (input.now_us, input.sensor_step_pa);
            let pneumatics = input.pneumatics;
            let cooling_s = input.chamber.cooling_s(pressure_pa, pneumatics.atmosphere, pneumatics.temperature_k);
            let heat_share = input.chamber.heat_share(pressure_pa, pneumatics.atmosphere);
            let settled_s = self.settled_for_us(now_us, pneumatics.timing) as f32 * 1e-6;
            let measurement = Measurement { now_us, pressure_pa, step_pa, drop_pa, settled_s, cooling_s, heat_share };
            if is_falling {
                self.balance.measure_falling(&measurement);
            } else {
                self.balance.measure(&measurement);
            }
        }
        if let Some(beyond_pa) = hindered_pa {
            self.balance.come_to_rest(beyond_pa);
        }
        let plan = if resting {
            self.plan_at_rest(input, reference, pressure_pa)
        } else {
            self.fine.restart();
            self.plan(input, reference, pressure_pa, sample.direction())
        };
        match plan.direction {
            Some(direction) if plan.coil_us > 0 => self.valves.pulse(direction, input.now_us, plan.coil_us),
            _ if self.fine.is_pairing() => {}
            _ => self.valves.close(input.now_us),
        }
        let fills = plan.direction == Some(Direction::Fill) || self.fine.is_pairing();
        if fills && input.supply_pa < pressure_pa + SUPPLY_MIN_PA {
            self.balance.interrupt();
        }
        let delay_us = if sample == Sample::Settled { input.pneumatics.timing.on_delay_us } else { 0 };
        self.balance.pulse(plan.modelled_pa, doubt(input, pressure_pa, plan.coil_us, delay_us));
        self.last = Some(Decision {
            at_us: input.now_us,
            pressure_pa,
            pulse: plan.direction,
            coil_us: plan.coil_us,
            modelled_pa: plan.modelled_pa,
            sample,
            drop_pa: modelled_drop_pa,
        });
    }

    fn sample_kind(&self, now_us: u64) -> Sample {
        match (self.open_since_last(now_us), self.last.map(|last| last.sample)) {
            (None, _) => Sample::Settled,
            (Some(direction), Some(Sample::Opening(_) | Sample::Steady(_))) => Sample::Steady(direction),
            (Some(direction), _) => Sample::Opening(direction),
        }
    }

    /// Whether the reading still settles after a pulse. Behind a valve that is wide for its line, that takes longer than the loop waits.
    fn settles(&self, step_pa: f32, pulse: Option<Direction>) -> bool {
        match pulse {
            Some(Direction::Fill) => step_pa < -STILL_PA,
            Some(Direction::Vent) => step_pa > STILL_PA,
            None => false,
        }
    }

    /// Effect of a short pulse beyond its prediction, Pa, in the direction of the pulse, if a sound line cannot swing that far.
    fn swing_pa(&self, input: &LoopInput, last: &Decision, direction: Direction, pressure_pa: f32) -> Option<f32> {
        let beyond_pa = pressure_pa - self.reckoned_pa(last);
        let swing_pa = if direction == Direction::Fill { beyond_pa } else { -beyond_pa };
        let settled_pa = input.pneumatics.settled_pa(direction, input.chamber, last.pressure_pa, input.supply_pa);
        (swing_pa > SWING_PA + SWING_DROPS * (last.pressure_pa - settled_pa).abs()).then_some(swing_pa)
    }

    /// The valve that is still open from the last period.
    fn open_since_last(&self, now_us: u64) -> Option<Direction> {
        // The coil of a bridging pulse ends exactly now.
        self.valves.direction_at(now_us.checked_sub(1)?)
    }

    /// Drop of the pressure along the line behind a steady flow by the model, Pa, signed; 0 without one.
    fn modelled_drop_pa(&self, input: &LoopInput, sample: Sample) -> f32 {
        match (sample, self.last) {
            (Sample::Settled, _) | (Sample::Opening(_), Some(_)) => 0.0,
            _ if !input.sensor_trusted => 0.0,
            (Sample::Opening(direction) | Sample::Steady(direction), _) => {
                let settled_pa =
                    input.pneumatics.settled_pa(direction, input.chamber, input.sensor_pa, input.supply_pa);
                input.sensor_pa - settled_pa
            }
        }
    }

    /// Gauge pressure at which the channel would come to rest, were its valves closed now, Pa.
    fn chamber_pressure_pa(&self, input: &LoopInput, sample: Sample, modelled_drop_pa: f32, resting: bool) -> f32 {
        match (sample, &self.last) {
            (Sample::Opening(_), Some(last)) => self.reckoned_pa(last),
            (_, Some(last)) if !input.sensor_trusted => self.reckoned_pa(last),
            (Sample::Opening(direction) | Sample::Steady(direction), _) => {
                input.sensor_pa - self.adaptation.line_drop(direction) * modelled_drop_pa
            }
            (Sample::Settled, _) => self.fine.mean_pa().filter(|_| resting).unwrap_or(input.sensor_pa),
        }
    }

    /// Predicted pressure after the last pulse, Pa.
    fn reckoned_pa(&self, last: &Decision) -> f32 {
        let gain = last.pulse.map_or(0.0, |direction| self.adaptation.gain(direction));
        last.pressure_pa + gain * last.modelled_pa
    }

    /// Learns from the last pulse if both samples are measured and of one kind: behind an open valve they carry a bias. Returns the
    /// difference between the settled reading and its prediction, Pa, signed, if it shows a kinked hose.
    fn learn(&mut self, input: &LoopInput, pressure_pa: f32, sample: Sample) -> Option<f32> {
        let last = self.last.take()?;
        let mut hindered_pa = None;
        if let (Sample::Steady(direction), Sample::Settled, true) = (last.sample, sample, input.sensor_trusted) {
            let innovation_pa = pressure_pa - self.reckoned_pa(&last);
            self.adaptation.learn_drop(direction, last.drop_pa, last.modelled_pa, innovation_pa);
            let returned_pa = if direction == Direction::Fill { -innovation_pa } else { innovation_pa };
            let is_hindered = returned_pa > HINDERED_PA + HINDERED_DROPS * last.drop_pa.abs();
            hindered_pa = is_hindered.then_some(innovation_pa);
        }
        if last.sample != sample
            || matches!(sample, Sample::Opening(_))
            || !input.sensor_trusted
            || self.fine.is_pairing()
        {
            return hindered_pa;
        }
        let duration_us = input.now_us.saturating_sub(last.at_us).max(1);
        self.adaptation.learn(&Effect {
            pulse: last.pulse,
            coil_beyond_delay_us: last.coil_us.saturating_sub(input.pneumatics.timing.on_delay_us),
            modelled_pa: last.modelled_pa,
            measured_pa: pressure_pa - last.pressure_pa,
            duration_s: duration_us as f32 * 1e-6,
        });
        hindered_pa
    }

    fn plan(&self, input: &LoopInput, reference: &Reference, pressure_pa: f32, open: Option<Direction>) -> Plan {
        let opening_us = if open.is_some() { 0 } else { input.pneumatics.timing.on_delay_us };
        let preview_us = opening_us + reference.rest_us(input.now_us) / 2;
        let first = self.pulse_model(input, reference, pressure_pa, preview_us);
        // A ramp is followed without bias when the pulse aims at the middle of the rest plus half the pulse.
        let wanted = self.pulse_model(input, reference, pressure_pa, preview_us + first.open_time_us() / 2);
        match open {
            // Only the vent can still be open where filling is not allowed: a ramp begins with closed valves.
            Some(direction) if direction == wanted.direction => wanted.plan(true),
            Some(direction) => wanted.closing(direction),
            None if wanted.direction == Direction::Fill && !input.may_fill => Plan::NOTHING,
            None if wanted.change_pa.abs() < wanted.deadband_pa() => Plan::NOTHING,
            None => wanted.plan(false),
        }
    }

    /// The pulse while the reference rests: a change below the shortest pulse takes two.
    fn plan_at_rest(&mut self, input: &LoopInput, reference: &Reference, pressure_pa: f32) -> Plan {
        if let Some(direction) = self.fine.learn(pressure_pa) {
            self.adaptation.missed(direction);
        }
        let wanted = self.pulse_model(input, reference, pressure_pa, reference.rest_us(input.now_us) / 2);
        let error_pa = wanted.change_pa;
        let mut fill = self.towards(Direction::Fill, &wanted);
        let least_up_pa = fill.shortest_effect_pa();
        let (band_pa, single_pa) = (self.fine.band_pa(least_up_pa, reference), wanted.deadband_pa());
        if self.fine.leaves(error_pa, band_pa, single_pa) {
            return Plan::NOTHING;
        }
        // Pairs have widened the band: air cools down or leaks, and single pulses follow it.
        let least_pa = if band_pa >= single_pa { single_pa } else { wanted.shortest_effect_pa() };
        if error_pa.abs() >= least_pa {
            return wanted.plan(false);
        }
        let requested_pa = self.fine.requested_pa(error_pa, reference);
        let mut vent = self.towards(Direction::Vent, &wanted);
        fill.change_pa = (requested_pa + BACK * vent.shortest_effect_pa()).max(BACK * least_up_pa);
        let above_pa = fill.change_pa - error_pa;
        if above_pa > ABOVE_PA || pressure_pa + fill.change_pa > input.pressure_max_pa {
            // As while the reference moves.
            return if error_pa.abs() < single_pa { Plan::NOTHING } else { wanted.plan(false) };
        }
        vent.change_pa = requested_pa - fill.change_pa;
        vent.pressure_pa = pressure_pa + fill.change_pa;
        let (before_pa, up_pa, down_pa) = (pressure_pa, fill.change_pa, -vent.change_pa);
        // The bias is the effect of the pair beyond the requested change.
        self.fine.begin(Pair { before_pa, desired_pa: requested_pa, up_pa, down_pa });
        let up = fill.plan(false);
        let down = vent.plan(false);
        // The balance takes modelled effects: without the gain.
        let delay_us = input.pneumatics.timing.on_delay_us;
        self.balance.pulse(up_pa / fill.gain, doubt(input, pressure_pa, up.coil_us, delay_us));
        self.balance.pulse(-down_pa / vent.gain, doubt(input, pressure_pa, down.coil_us, delay_us));
        self.valves.pair(input.now_us, (Direction::Fill, up.coil_us), (Direction::Vent, down.coil_us));
        Plan { direction: None, ..Plan::NOTHING }
    }

    fn towards<'a>(&self, direction: Direction, model: &PulseModel<'a>) -> PulseModel<'a> {
        let (gain, margin_us) = (self.adaptation.gain(direction), self.adaptation.margin_us(direction));
        PulseModel { direction, gain, margin_us, ..*model }
    }

    fn pulse_model<'a>(
        &self,
        input: &'a LoopInput,
        reference: &Reference,
        pressure_pa: f32,
        preview_us: u32,
    ) -> PulseModel<'a> {
        let target_pa = reference.at(input.now_us.saturating_add(u64::from(preview_us)));
        let drift_pa = self.adaptation.drift_pa_per_s() * preview_us as f32 * 1e-6;
        let change_pa = target_pa - pressure_pa - drift_pa;
        let direction = if change_pa >= 0.0 { Direction::Fill } else { Direction::Vent };
        PulseModel {
            input,
            direction,
            pressure_pa,
            change_pa,
            gain: self.adaptation.gain(direction),
            margin_us: self.adaptation.margin_us(direction),
            rest_us: reference.rest_us(input.now_us),
        }
    }
}

/// Relative uncertainty of a pulse's effect, from the chamber and from the opening delay. The delay is 0 for a valve that is already open.
fn doubt(input: &LoopInput, pressure_pa: f32, coil_us: u32, delay_us: u32) -> f32 {
    let open_us = coil_us.saturating_add(input.pneumatics.timing.off_delay_us).saturating_sub(delay_us).max(1);
    let of_delay = (DELAY_DOUBT * delay_us as f32 / open_us as f32).min(DELAY_DOUBT_MAX);
    input.chamber.doubt(pressure_pa, input.pneumatics.atmosphere) + of_delay
}

impl Default for PressureLoop {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::Orifice;
    use crate::gas::Absolute;

    /// A chamber of 2.5 L whose pressure changes by 4 kPa/s at most: a drift beyond the valve's rate, which noise can teach, must not turn
    /// the valves away from the reference. Carried on for the seconds that 10 kPa take, it would.
    #[test]
    fn drift_does_not_turn_a_slow_chamber_away_from_its_reference() {
        let timing = ValveTiming { on_delay_us: 3_500, off_delay_us: 2_000 };
        let pneumatics = Pneumatics::new(
            Orifice::new(1.2e-9, 0.3),
            Orifice::line(3.78e-9),
            Absolute::new(101_325.0),
            293.15,
            timing,
        );
        let chamber = Chamber {
            pressure_pa: 120e3,
            volume_m3: 2.24e-3,
            compliance_m3_per_pa: 20e-9,
            rest_volume_m3: 1.1e-3,
            dead_volume_m3: 6e-6,
        };
        for (drift_pa_per_s, off_pa, towards) in
            [(-10e3, 10e3, Direction::Vent), (10e3, -10e3, Direction::Fill), (-10e3, -10e3, Direction::Fill)]
        {
            let mut control = PressureLoop::new();
            for _ in 0..60 {
                let measured_pa = drift_pa_per_s * 0.02;
                control.adaptation.learn(&Effect {
                    pulse: None,
                    coil_beyond_delay_us: 0,
                    modelled_pa: 0.0,
                    measured_pa,
                    duration_s: 0.02,
                });
            }
            assert!((control.adaptation.drift_pa_per_s() / drift_pa_per_s - 1.0).abs() < 1e-3);
            let input = LoopInput {
                now_us: 100_000,
                sensor_pa: 120e3 + off_pa,
                sensor_step_pa: 0.0,
                sensor_trusted: true,
                supply_pa: 250e3,
                pressure_max_pa: 200e3,
                may_fill: true,
                chamber: &chamber,
                pneumatics: &pneumatics,
            };
            let reference = Reference { start_us: 100_000, start_pa: 120e3, period_us: 20_000, end_pa: 120e3 };
            control.decide(&input, &reference);
            assert_eq!(control.valves.direction_at(100_001), Some(towards), "{drift_pa_per_s} Pa/s, {off_pa} Pa off");
        }
    }
}
