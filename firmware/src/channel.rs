//! One channel from sample to coil times.

use softlimb_protocol::{FaultCode, PressureLoopKind};

use crate::config::{ChannelConfig, SystemConfig};
use crate::duty::Duty;
use crate::inverse::Inverse;
use crate::observer::{Observation, Observer};
use crate::pressure_loop::{LoopInput, PressureLoop};
use crate::reference::Reference;
use crate::relief::Relief;
use crate::sensor::{AdcCode, RESTLESS_MEANS, Sensor, ZeroCheck};
use crate::valve::{Direction, ValvePulse};

/// Samples in a row above the limit that trip the over-pressure fault.
const OVER_PRESSURE_SAMPLES: u8 = 2;

/// Part of the modelled line drop by which the manifold may read above the limit while filling: the drop and half of it again.
const DROP_ALLOWANCE: f32 = 1.5;

/// Demand of the device on a channel in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Task {
    /// Valves closed.
    Close,
    /// Follow the setpoint: its value now and one control period later, SI units, where there is one.
    Track(Option<(f32, f32)>),
    /// Ramp down, then open the vent.
    Relieve,
    /// Vent open.
    Open,
}

/// Inputs of one tick that all channels share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TickContext<'a> {
    pub(crate) now_us: u64,
    pub(crate) system: &'a SystemConfig,
    pub(crate) supply_pa: f32,
}

/// State of one channel.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    sensor: Sensor,
    zero: ZeroCheck,
    control: PressureLoop,
    observer: Observer,
    /// Whether the reading is that of another pressure, as the observer found.
    is_deceived: bool,
    inverse: Inverse,
    relief: Relief,
    reference: Option<Reference>,
    decision_due: bool,
    over_samples: u8,
    vent_latched: bool,
    /// Pulse by hand that has not begun: valve and coil time, us.
    requested: Option<(Direction, u32)>,
    duty: Duty,
}

impl Channel {
    pub(crate) const fn new() -> Self {
        Self {
            sensor: Sensor::new(),
            zero: ZeroCheck::new(),
            control: PressureLoop::new(),
            observer: Observer::new(),
            is_deceived: false,
            inverse: Inverse::new(),
            relief: Relief::new(),
            reference: None,
            decision_due: false,
            over_samples: 0,
            vent_latched: false,
            requested: None,
            duty: Duty::new(),
        }
    }

    /// Calibrated gauge pressure, Pa.
    pub fn pressure_pa(&self) -> f32 {
        self.sensor.pressure_pa()
    }

    /// The sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The inverse model.
    pub fn inverse(&self) -> &Inverse {
        &self.inverse
    }

    /// Pressure loop: estimates and coils.
    pub fn control(&self) -> &PressureLoop {
        &self.control
    }

    /// Gauge pressure that the loop tracks at a time, Pa; `None` while it tracks nothing.
    pub fn reference_pa(&self, now_us: u64) -> Option<f32> {
        self.reference.map(|reference| reference.at(now_us))
    }

    /// Share of the last control period for which the valves' coils were energized.
    pub fn duty(&self) -> &Duty {
        &self.duty
    }

    /// Whether a fault keeps the vent open.
    pub fn is_vent_latched(&self) -> bool {
        self.vent_latched
    }

    /// Whether a ramp down has ended in an open vent.
    pub fn is_venting_open(&self) -> bool {
        self.relief.is_open()
    }

    /// Takes the sample of this tick.
    pub(crate) fn sense(&mut self, context: &TickContext, code: AdcCode) {
        self.sensor.sample(&context.system.sensor, code);
    }

    /// Averages the reading of a chamber whose vent is open; `Some` when its mean is known. It is an error, with the mean, Pa, where that is too
    /// far off: from nothing where the zero is `taken`, which is then set, else below the zero. Above it, air may be left in the chamber.
    /// A zero is taken of a reading that rests.
    pub(crate) fn check_zero(&mut self, system: &SystemConfig, taken: bool) -> Option<Result<(), f32>> {
        let mean = self.zero.add(self.sensor.raw_pa())?;
        if taken && mean.change_pa.abs() > system.sensor.rest_limit_pa() {
            return (mean.count >= RESTLESS_MEANS).then_some(Err(mean.mean_pa));
        }
        let off_pa = if taken { mean.mean_pa.abs() } else { self.sensor.zero_pa() - mean.mean_pa };
        if off_pa > system.sensor.zero_limit_pa() {
            return Some(Err(mean.mean_pa));
        }
        if taken {
            self.sensor.set_zero(mean.mean_pa);
        }
        Some(Ok(()))
    }

    /// The pressure, Pa, once two samples in a row exceed the limit.
    pub(crate) fn over_pressure_pa(&mut self, context: &TickContext, config: &ChannelConfig) -> Option<f32> {
        let (pressure_pa, limit_pa) = (self.sensor.pressure_pa(), config.pressure_max_pa);
        // The line drop is a flow through two orifices: reckoned only where it decides.
        let over = !self.sensor.is_implausible()
            && pressure_pa > limit_pa
            && pressure_pa > limit_pa + self.line_drop_pa(context, config);
        self.over_samples = if over { self.over_samples.saturating_add(1) } else { 0 };
        (self.over_samples >= OVER_PRESSURE_SAMPLES).then_some(pressure_pa)
    }

    /// Compares the reading with the effect that the model expects of the valves. Returns a fault once it has lasted.
    pub(crate) fn observe(
        &mut self,
        context: &TickContext,
        config: &ChannelConfig,
        code: AdcCode,
    ) -> Option<FaultCode> {
        if self.sensor.is_implausible() {
            self.believe();
            return None;
        }
        let pneumatics = &context.system.pneumatics;
        let found = self.observer.observe(&Observation {
            code,
            reading_pa: self.pressure_pa(),
            supply_pa: context.supply_pa,
            is_line_moving: self.control.is_line_moving(context.now_us, pneumatics.timing),
            chamber: &self.inverse.chamber(config),
            pneumatics,
        });
        let found = found.or(self.control.balance().finding().filter(|_| !self.observer.is_unchanged()));
        self.is_deceived |= found.is_some();
        found
    }

    /// Believes the next reading.
    pub(crate) fn believe(&mut self) {
        self.observer.restart();
        self.control.restart_balance();
    }

    /// Whether the loop and the ramp down may go by the reading.
    fn is_sensor_trusted(&self) -> bool {
        !self.is_deceived && !self.sensor.is_implausible()
    }

    /// Keeps the vent open until faults are cleared.
    pub(crate) fn latch_vent(&mut self) {
        self.vent_latched = true;
    }

    /// Resets the state of the cleared faults.
    pub(crate) fn clear_faults(&mut self) {
        self.vent_latched = false;
        self.over_samples = 0;
        self.is_deceived = false;
        self.believe();
        self.inverse.forgive();
    }

    /// Forgets the actuator, as a new configuration does; the sensor and its zero stay.
    pub(crate) fn reconfigure(&mut self) {
        *self = Self { sensor: self.sensor, ..Self::new() };
    }

    /// A new state begins: valves closed, nothing tracked, a ramp down from the beginning.
    pub(crate) fn restart(&mut self, now_us: u64) {
        self.rest(now_us, ValvePulse::CLOSED);
        self.relief = Relief::new();
        self.zero = ZeroCheck::new();
        self.requested = None;
    }

    /// Wants a valve opened by hand from the next tick on, while the channel has nothing else to do.
    pub(crate) fn request(&mut self, direction: Direction, coil_us: u32) {
        self.requested = Some((direction, coil_us));
    }

    /// Whether a ramp down has come to its end and the sensor reads an empty chamber.
    pub(crate) fn is_relieved(&self, now_us: u64) -> bool {
        self.relief.is_done(now_us)
    }

    /// Coil times of this tick. `slot`: the control period of this channel begins.
    pub(crate) fn drive(
        &mut self,
        context: &TickContext,
        config: &ChannelConfig,
        task: Task,
        slot: bool,
    ) -> ValvePulse {
        let pulse = match task {
            Task::Close => self.keep(context.now_us, config),
            Task::Open => self.rest(context.now_us, ValvePulse::VENTING),
            Task::Track(setpoints) => {
                if slot {
                    self.aim(context, config, setpoints);
                }
                self.pulse(context, config, true)
            }
            Task::Relieve => self.relieve(context, config, slot),
        };
        self.observer.drive(pulse, context.system.pneumatics.timing);
        self.duty.add(pulse, slot, context.system.control_period_us());
        pulse
    }

    fn rest(&mut self, now_us: u64, pulse: ValvePulse) -> ValvePulse {
        self.control.close(now_us);
        self.reference = None;
        self.decision_due = false;
        pulse
    }

    /// Keeps the valves closed but for a pulse by hand; a filling one ends early where the loop's references end. An open valve is one of
    /// these: whatever else had opened one, [`restart`](Self::restart) has closed it.
    fn keep(&mut self, now_us: u64, config: &ChannelConfig) -> ValvePulse {
        let is_full = self.pressure_pa() >= config.reference_max_pa();
        let valves = self.control.valves_mut();
        if let Some((direction, coil_us)) = self.requested.take() {
            valves.pulse(direction, now_us, coil_us);
        }
        match valves.direction_at(now_us) {
            Some(Direction::Fill) if is_full => self.rest(now_us, ValvePulse::CLOSED),
            Some(_) => valves.tick(now_us),
            None => self.rest(now_us, ValvePulse::CLOSED),
        }
    }

    /// Sets the reference of the control period that begins now.
    fn aim(&mut self, context: &TickContext, config: &ChannelConfig, setpoints: Option<(f32, f32)>) {
        let Some((start, end)) = setpoints else { return };
        let start_pa = match self.reference_pa(context.now_us) {
            Some(pressure_pa) => Some(pressure_pa),
            None => self.inverse.pressure_pa(config, start),
        };
        let end_pa = self.inverse.pressure_pa(config, end);
        if let (Some(start_pa), Some(end_pa)) = (start_pa, end_pa) {
            self.set_reference(context, start_pa, end_pa);
        }
    }

    fn relieve(&mut self, context: &TickContext, config: &ChannelConfig, slot: bool) -> ValvePulse {
        let pressure_pa = self.pressure_pa();
        let trusted = self.is_sensor_trusted();
        let ramp = self.relief.advance(context.now_us, pressure_pa, trusted, context.system.vent_ramp_pa_per_s);
        if ramp.is_open() {
            return self.rest(context.now_us, ValvePulse::VENTING);
        }
        if slot {
            let end_us = context.now_us.saturating_add(u64::from(context.system.control_period_us()));
            let end_pa = ramp.at(end_us);
            self.inverse.follow_pressure(config, end_pa);
            self.set_reference(context, ramp.at(context.now_us), end_pa);
        }
        self.pulse(context, config, false)
    }

    fn set_reference(&mut self, context: &TickContext, start_pa: f32, end_pa: f32) {
        let period_us = context.system.control_period_us();
        self.reference = Some(Reference { start_us: context.now_us, start_pa, period_us, end_pa });
        self.decision_due = true;
    }

    /// Decides by the loop of the configuration, and cuts the pulse into ticks. What only lets air out, and a reading that is not trusted, take
    /// the predicted pulses.
    fn pulse(&mut self, context: &TickContext, config: &ChannelConfig, may_fill: bool) -> ValvePulse {
        let (now_us, pneumatics) = (context.now_us, &context.system.pneumatics);
        self.control.sample(now_us, pneumatics.timing, self.sensor.pressure_pa(), self.sensor.step_pa());
        if let Some(reference) = self.reference {
            let trusted = self.is_sensor_trusted();
            let is_chosen = |kind: PressureLoopKind| may_fill && trusted && context.system.pressure_loop == kind;
            if is_chosen(PressureLoopKind::OnOff) {
                self.control.decide_on_off(now_us, self.pressure_pa(), &reference);
            } else if self.is_decision_due(context, &reference) {
                self.decision_due = false;
                let input = LoopInput {
                    now_us,
                    sensor_pa: self.pressure_pa(),
                    sensor_step_pa: self.sensor.step_pa(),
                    sensor_trusted: trusted,
                    supply_pa: context.supply_pa,
                    pressure_max_pa: config.pressure_max_pa,
                    may_fill,
                    chamber: &self.inverse.chamber(config),
                    pneumatics,
                };
                if is_chosen(PressureLoopKind::ProportionalIntegral) {
                    self.control.decide_proportional_integral(&input, &reference);
                } else {
                    self.control.decide(&input, &reference);
                }
            }
        }
        self.control.valves_mut().tick(now_us)
    }

    /// Whether the sample is fit for the decision of the period, and half of the period is left.
    fn is_decision_due(&self, context: &TickContext, reference: &Reference) -> bool {
        let (now_us, timing) = (context.now_us, context.system.pneumatics.timing);
        self.decision_due
            && reference.rest_us(now_us) >= reference.period_us / 2
            && self.control.is_due(now_us, timing, self.sensor.step_pa(), reference)
    }

    /// Largest reading of the manifold above the chamber, Pa: the line drop while filling and until it has settled.
    fn line_drop_pa(&self, context: &TickContext, config: &ChannelConfig) -> f32 {
        let pneumatics = &context.system.pneumatics;
        if !self.control.is_line_moving(context.now_us, pneumatics.timing) {
            return 0.0;
        }
        let (chamber, pressure_pa) = (self.inverse.chamber(config), self.pressure_pa());
        let inside_pa = pneumatics.settled_pa(Direction::Fill, &chamber, pressure_pa, context.supply_pa);
        DROP_ALLOWANCE * (pressure_pa - inside_pa).max(0.0)
    }
}
