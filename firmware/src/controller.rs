//! The controller: link bytes and samples in, link bytes and coil times out.
//!
//! One tick: sense, supervise (`supervise.rs`), drive the channels, report. Messages act between ticks (`dispatch.rs`).

use core::num::NonZeroU32;

use heapless::Vec;
use softlimb_protocol::{
    BootCause, Decoder, DeviceState, FaultCode, HostMessage, LinkErrors, MAX_CHANNELS, Outputs, SeqDedup,
};

use crate::channel::{Channel, Task, TickContext};
use crate::config::{ActiveConfig, StagedConfig};
use crate::faults::Faults;
use crate::link::Link;
use crate::outbox::Outbox;
use crate::queue::KnotQueue;
use crate::safety::{Lasting, TickWatch};
use crate::sampling::Sampling;
use crate::sensor::{AdcCode, Sensor, Zeros};
use crate::valve::ValvePulse;

/// Part of the supply's range over which the pump slows down to stop at its upper end.
const PUMP_BAND: f32 = 0.1;

/// Board data at start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BootInfo {
    /// Why the device started.
    pub cause: BootCause,
    /// Place of the last stop: line of the source or address of the instruction, by the cause; 0 where that is unknown.
    pub detail: u32,
}

impl BootInfo {
    /// Whether the program had stopped before: what it left in the limb, nobody has regulated since.
    #[must_use]
    pub const fn is_after_crash(self) -> bool {
        match self.cause {
            BootCause::Panic
            | BootCause::HardFault
            | BootCause::Watchdog
            | BootCause::ClockFailure
            | BootCause::ImageDamaged => true,
            BootCause::PowerOn | BootCause::ResetPin | BootCause::Software | BootCause::BrownOut => false,
        }
    }
}

/// Inputs of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickInputs<const N: usize = MAX_CHANNELS> {
    /// Time since start, us.
    pub now_us: u64,
    /// Samples of the channel sensors.
    pub pressure: [AdcCode; N],
    /// Sample of the supply sensor.
    pub supply: AdcCode,
    /// Sample of the voltage of the valves' supply; any where the board does not sense it.
    pub valve_supply: AdcCode,
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
}

/// Outputs of a tick, from its start to the start of the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickOutputs<const N: usize = MAX_CHANNELS> {
    /// Coil times.
    pub valves: [ValvePulse; N],
    /// The supply valve is energized.
    pub supply_open: bool,
    /// Pump speed, `0..=255` of full.
    pub pump_duty: u8,
    /// State of the digital outputs.
    pub digital: Outputs,
}

impl<const N: usize> TickOutputs<N> {
    /// Everything off: no valve energized, pressure kept, supply cut.
    pub const SAFE: Self =
        Self { valves: [ValvePulse::CLOSED; N], supply_open: false, pump_duty: 0, digital: Outputs::from_bits(0) };

    /// Everything off but the vents, which are open.
    pub const VENTING: Self = Self { valves: [ValvePulse::VENTING; N], ..Self::SAFE };
}

/// The controller of up to `N` channels, at most 27: as many as the board has. Nothing but the number depends on it.
#[derive(Clone, Debug)]
pub struct Controller<const N: usize = MAX_CHANNELS> {
    pub(crate) boot: BootInfo,
    pub(crate) state: DeviceState,
    pub(crate) config: Option<ActiveConfig<N>>,
    pub(crate) staged: StagedConfig<N>,
    /// As many as the configuration has.
    pub(crate) channels: Vec<Channel, N>,
    pub(crate) zeros: Zeros,
    pub(crate) supply: Sensor,
    /// Voltage of the valves' supply, mV.
    pub(crate) valve_supply_mv: u16,
    pub(crate) queue: KnotQueue<N>,
    pub(crate) start_us: Option<u64>,
    /// Digital outputs: a knot or a request switches them, no state and no fault does. Off from the start of the device on.
    pub(crate) outputs: Outputs,
    pub(crate) faults: Faults,
    pub(crate) stop_requested: bool,
    pub(crate) stop_pressed: bool,
    pub(crate) state_since_us: u64,
    /// A valve was opened by hand since the state began.
    pub(crate) is_by_hand: bool,
    pub(crate) vent_at_once: bool,
    pub(crate) link: Link,
    pub(crate) decoder: Decoder<HostMessage>,
    pub(crate) dedup: SeqDedup,
    pub(crate) outbox: Outbox,
    pub(crate) ticks: TickWatch,
    pub(crate) supply_low: Lasting,
    pub(crate) supply_high: Lasting,
    pub(crate) valve_supply_low: Lasting,
    pub(crate) tick_count: u32,
    pub(crate) telemetry_due_us: u64,
    pub(crate) sampling: Sampling,
    pub(crate) stack_used: u16,
    /// First record of the log that the host requests.
    pub(crate) log_request: Option<NonZeroU32>,
    pub(crate) link_errors: LinkErrors,
    pub(crate) link_errors_changed: bool,
    pub(crate) link_errors_due_us: u64,
}

impl<const N: usize> Controller<N> {
    /// Idle, without configuration, valves closed; after a crash Venting, with all vents open.
    pub const fn new(boot: BootInfo) -> Self {
        const { assert!(N >= 1 && N <= MAX_CHANNELS, "one to 27 channels") };
        let is_after_crash = boot.is_after_crash();
        Self {
            boot,
            state: if is_after_crash { DeviceState::Venting } else { DeviceState::Idle },
            config: None,
            staged: StagedConfig::new(),
            channels: Vec::new(),
            zeros: Zeros::Unknown,
            supply: Sensor::new(),
            valve_supply_mv: 0,
            queue: KnotQueue::new(),
            start_us: None,
            outputs: Outputs::from_bits(0),
            faults: Faults::new(),
            stop_requested: false,
            stop_pressed: false,
            state_since_us: 0,
            is_by_hand: false,
            vent_at_once: is_after_crash,
            link: Link::new(),
            decoder: Decoder::new(),
            dedup: SeqDedup::new(),
            outbox: Outbox::new(),
            ticks: TickWatch::new(),
            supply_low: Lasting::new(),
            supply_high: Lasting::new(),
            valve_supply_low: Lasting::new(),
            tick_count: 0,
            telemetry_due_us: 0,
            sampling: Sampling::new(),
            stack_used: 0,
            log_request: None,
            link_errors: LinkErrors::NONE,
            link_errors_changed: false,
            link_errors_due_us: 0,
        }
    }

    /// Takes why the device started, where that is known only after the controller was placed in memory. Call it before the first tick.
    pub fn set_boot(&mut self, boot: BootInfo) {
        self.boot = boot;
        if boot.is_after_crash() {
            self.state = DeviceState::Venting;
            self.vent_at_once = true;
        }
    }

    /// Takes the most that the stack has held since the start, bytes, for the telemetry; 0 where it is not measured.
    pub fn set_stack_used(&mut self, stack_used: u16) {
        self.stack_used = stack_used;
    }

    /// Takes the errors of the link's port since the start.
    pub fn set_link_errors(&mut self, errors: LinkErrors) {
        self.link_errors_changed |= errors != self.link_errors;
        self.link_errors = errors;
    }

    /// State of the device.
    pub fn state(&self) -> DeviceState {
        self.state
    }

    /// The latched faults.
    pub fn faults(&self) -> &Faults {
        &self.faults
    }

    /// The configuration in force.
    pub fn config(&self) -> Option<&ActiveConfig<N>> {
        self.config.as_ref()
    }

    /// One channel of the configuration, from 0.
    pub fn channel(&self, index: usize) -> Option<&Channel> {
        self.channels.get(index)
    }

    /// The setpoint buffer.
    pub fn queue(&self) -> &KnotQueue<N> {
        &self.queue
    }

    /// Calibrated gauge pressure of the supply, Pa.
    pub fn supply_pa(&self) -> f32 {
        self.supply.pressure_pa()
    }

    /// Takes bytes from the link at `now_us`, in any chunking.
    pub fn receive(&mut self, now_us: u64, bytes: &[u8]) {
        for &byte in bytes {
            if let Some(Ok(frame)) = self.decoder.push(byte) {
                self.dispatch(now_us, frame.seq, &frame.message);
            }
        }
    }

    /// Moves bytes for the link to `out`; returns how many.
    pub fn transmit(&mut self, out: &mut [u8]) -> usize {
        self.outbox.drain(out)
    }

    /// One control tick; call it every millisecond.
    pub fn tick(&mut self, inputs: &TickInputs<N>) -> TickOutputs<N> {
        let outputs = self.act(inputs);
        self.report(inputs, &outputs);
        outputs
    }

    /// A tick without its messages.
    pub(crate) fn act(&mut self, inputs: &TickInputs<N>) -> TickOutputs<N> {
        let now_us = inputs.now_us;
        self.sense(inputs);
        self.supervise(inputs);
        let outputs = TickOutputs { digital: self.outputs, ..self.drive(now_us) };
        self.tick_count = self.tick_count.wrapping_add(1);
        outputs
    }

    /// Believes the next reading of every channel, whatever the valves did. Called before each tick, no fault comes of effects: for a program
    /// that runs a controller on readings which are not those of its valves.
    pub fn believe_readings(&mut self) {
        self.channels.iter_mut().for_each(Channel::believe);
    }

    fn sense(&mut self, inputs: &TickInputs<N>) {
        let Some(config) = &self.config else { return };
        self.supply.sample(&config.system.supply_sensor, inputs.supply);
        self.valve_supply_mv = config.system.valve_supply.millivolts(inputs.valve_supply);
        let context =
            TickContext { now_us: inputs.now_us, system: &config.system, supply_pa: self.supply.pressure_pa() };
        for ((channel, _), &code) in self.channels.iter_mut().zip(&config.channels).zip(&inputs.pressure) {
            channel.sense(&context, code);
        }
    }

    fn drive(&mut self, now_us: u64) -> TickOutputs<N> {
        let mut outputs = TickOutputs::SAFE;
        let Some(config) = &self.config else {
            // A reset may have left air in the limb: what lets it out works without a configuration too.
            let vents = self.state == DeviceState::Venting || self.faults.contains(FaultCode::EmergencyStop);
            return if vents { TickOutputs::VENTING } else { outputs };
        };
        let system = &config.system;
        let context = TickContext { now_us, system, supply_pa: self.supply.pressure_pa() };
        let relief = self.relief(now_us);
        let period = system.control_period_ticks;
        let phase = self.tick_count % period;
        let count = config.channels.len() as u32;
        let channels = self.channels.iter_mut().zip(&config.channels).zip(&mut outputs.valves);
        for (index, ((channel, channel_config), valves)) in channels.enumerate() {
            // The channels' control periods are spread over the ticks.
            let slot = phase == index as u32 * period / count;
            let task = match relief {
                _ if channel.is_vent_latched() => Task::Open,
                Some(task) => task,
                None => Task::Track(if slot { setpoints(&self.queue, channel_config, index, &context) } else { None }),
            };
            *valves = channel.drive(&context, channel_config, task, slot);
        }
        (outputs.supply_open, outputs.pump_duty) = self.drive_supply(config);
        outputs
    }

    /// Demand of the state on every channel; `None` while running.
    fn relief(&self, now_us: u64) -> Option<Task> {
        match self.state {
            DeviceState::Running => None,
            // A chamber at rest may hold air: its zero is that of a reading which rests while the vent is open.
            DeviceState::Idle if self.zeros != Zeros::Checked && self.has_plausible_sensors() => Some(Task::Open),
            DeviceState::Venting if self.vent_at_once => Some(Task::Open),
            DeviceState::Venting => Some(Task::Relieve),
            DeviceState::Faulted if self.faults.contains(FaultCode::EmergencyStop) => Some(Task::Open),
            DeviceState::Faulted if self.is_hold_time_over(now_us) => Some(Task::Relieve),
            _ => Some(Task::Close),
        }
    }

    fn drive_supply(&self, config: &ActiveConfig<N>) -> (bool, u8) {
        let stopped = matches!(self.state, DeviceState::Idle | DeviceState::Venting);
        if stopped || self.faults.cuts_supply() || self.supply.is_implausible() {
            return (false, 0);
        }
        let (low_pa, high_pa) = (config.system.supply_min_pa, config.system.supply_max_pa);
        let band_pa = PUMP_BAND * (high_pa - low_pa);
        // Stops one band below the limit, so that the limit is a fault and not the set point. The cast saturates.
        let duty = 255.0 * (high_pa - band_pa - self.supply.pressure_pa()) / band_pa;
        // Ready needs no air yet: a fill valve that stays open would fill a chamber that no observer watches.
        (self.state != DeviceState::Ready, duty as u8)
    }
}

/// Value of a channel's setpoint now and one control period later, SI units.
fn setpoints<const N: usize>(
    queue: &KnotQueue<N>,
    config: &crate::config::ChannelConfig,
    index: usize,
    context: &TickContext,
) -> Option<(f32, f32)> {
    let units = config.setpoint_kind.units_per_si();
    let end_us = context.now_us.saturating_add(u64::from(context.system.control_period_us()));
    let start = queue.value(index, context.now_us)? / units;
    Some((start, queue.value(index, end_us)? / units))
}
