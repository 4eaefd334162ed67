//! Watching and deciding: faults, link, states. One pass per tick, before the channels are driven.

use softlimb_protocol::{DeviceState, FaultCode, LinkLossPolicy, SYSTEM_CHANNEL};

use crate::channel::TickContext;
use crate::controller::{Controller, TickInputs};
use crate::faults::{Occurrence, VentScope, reaction};
use crate::observer;
use crate::safety::{SUPPLY_HIGH_TICKS, SUPPLY_LOW_TICKS, VALVE_SUPPLY_LOW_TICKS};
use crate::sensor::Zeros;
use crate::state::{Event, next};

impl<const N: usize> Controller<N> {
    pub(crate) fn supervise(&mut self, inputs: &TickInputs<N>) {
        let now_us = inputs.now_us;
        if self.ticks.is_first() {
            self.state_since_us = now_us;
        }
        self.stop_pressed = inputs.emergency_stop;
        if inputs.emergency_stop || core::mem::take(&mut self.stop_requested) {
            self.fault(now_us, SYSTEM_CHANNEL, FaultCode::EmergencyStop, 0);
        }
        self.watch_ticks(now_us);
        // Before the observers of valves: it names the cause of what they would find.
        self.watch_valve_supply(now_us);
        // What vents after a crash has no configuration to tell what the sensors mean.
        if self.state != DeviceState::Idle && self.config.is_some() {
            self.watch_sensors(now_us);
            self.watch_pressures(now_us);
            self.watch_effects(inputs);
            self.watch_supply(now_us);
        }
        self.watch_link(now_us);
        self.follow_setpoints(now_us);
        self.watch_venting(now_us);
        self.watch_readiness(now_us);
    }

    /// Changes the state where the table has a transition; true if it did.
    pub(crate) fn apply(&mut self, now_us: u64, event: Event) -> bool {
        let Some(state) = next(self.state, event) else { return false };
        self.state = state;
        self.state_since_us = now_us;
        self.start_us = None;
        self.is_by_hand = false;
        self.vent_at_once = false;
        if event == Event::Vented && self.zeros == Zeros::Checked {
            self.zeros = Zeros::Stored;
        }
        self.channels.iter_mut().for_each(|channel| channel.restart(now_us));
        true
    }

    /// Latches a fault and reacts to it, even to one that was latched before without stopping the device, as by the zero check.
    pub(crate) fn fault(&mut self, now_us: u64, channel: u8, code: FaultCode, value: i32) {
        self.faults.raise(Occurrence { time_us: now_us, code, channel, value });
        let reaction = reaction(code);
        if reaction.vents == VentScope::Channel
            && let Some(channel) = self.channels.get_mut(usize::from(channel))
        {
            channel.latch_vent();
        }
        if reaction.latches {
            self.apply(now_us, Event::Fault);
        }
    }

    /// Whether the pressure has been held for as long as the configuration wants before the ramp down.
    pub(crate) fn is_hold_time_over(&self, now_us: u64) -> bool {
        self.config.as_ref().is_some_and(|config| {
            config.system.link_loss_policy != LinkLossPolicy::Hold
                && now_us.saturating_sub(self.state_since_us) >= u64::from(config.system.hold_time_us)
        })
    }

    /// A fault whose cause is still there, if any: clearing is refused.
    pub(crate) fn standing_fault(&self) -> Option<FaultCode> {
        let Some(config) = &self.config else {
            return self.stop_pressed.then_some(FaultCode::EmergencyStop);
        };
        let mut channels = self.channels.iter().zip(&config.channels);
        let implausible = !self.has_plausible_sensors();
        let over = channels.any(|(channel, config)| channel.pressure_pa() > config.pressure_max_pa);
        [
            (self.stop_pressed, FaultCode::EmergencyStop),
            (implausible, FaultCode::SensorImplausible),
            (over, FaultCode::OverPressure),
            (self.supply.pressure_pa() > config.system.supply_max_pa, FaultCode::SupplyHigh),
            (self.lacks_valve_voltage(), FaultCode::ValveSupplyLow),
        ]
        .into_iter()
        .find_map(|(stands, code)| stands.then_some(code))
    }

    /// Whether those of the supply and of every channel are plausible.
    pub(crate) fn has_plausible_sensors(&self) -> bool {
        let count = self.config.as_ref().map_or(0, |config| config.channels.len());
        !self.supply.is_implausible()
            && !self.channels.iter().take(count).any(|channel| channel.sensor().is_implausible())
    }

    /// Whether the voltage of the valves' supply is watched and too low for the coils.
    pub(crate) fn lacks_valve_voltage(&self) -> bool {
        self.config.as_ref().is_some_and(|config| self.valve_supply_mv < config.system.valve_supply_min_mv)
    }

    fn watch_ticks(&mut self, now_us: u64) {
        if let Some(distance_us) = self.ticks.tick(now_us)
            && self.state == DeviceState::Running
        {
            let distance_us = i32::try_from(distance_us).unwrap_or(i32::MAX);
            self.fault(now_us, SYSTEM_CHANNEL, FaultCode::TickOverrun, distance_us);
        }
    }

    fn watch_sensors(&mut self, now_us: u64) {
        if self.supply.is_implausible() {
            self.fault(now_us, SYSTEM_CHANNEL, FaultCode::SensorImplausible, self.supply.raw_pa() as i32);
        }
        let count = self.config.as_ref().map_or(0, |config| config.channels.len());
        for index in 0..count {
            let Some(channel) = self.channels.get(index) else { break };
            let pressure_pa = channel.sensor().raw_pa() as i32;
            let (implausible, lost) = (channel.sensor().is_implausible(), channel.inverse().is_at_fault());
            if implausible {
                self.fault(now_us, index as u8, FaultCode::SensorImplausible, pressure_pa);
            }
            if lost {
                self.fault(now_us, index as u8, FaultCode::InverseFailed, pressure_pa);
            }
        }
    }

    fn watch_pressures(&mut self, now_us: u64) {
        for index in 0..self.channels.len() {
            let Some(config) = &self.config else { return };
            let context = TickContext { now_us, system: &config.system, supply_pa: self.supply.pressure_pa() };
            let over_pa = match (self.channels.get_mut(index), config.channels.get(index)) {
                (Some(channel), Some(channel_config)) => channel.over_pressure_pa(&context, channel_config),
                _ => return,
            };
            if let Some(pressure_pa) = over_pa {
                self.fault(now_us, index as u8, FaultCode::OverPressure, pressure_pa as i32);
            }
        }
    }

    /// Effort without effect, and effect without effort. Venting empties whatever is there and needs no watching; an operator may have any
    /// vessel behind a valve, or none.
    fn watch_effects(&mut self, inputs: &TickInputs<N>) {
        let now_us = inputs.now_us;
        let tick = self.tick_count;
        let is_watched = match self.state {
            DeviceState::Running => true,
            DeviceState::Holding => !self.is_by_hand,
            _ => false,
        };
        for index in (0..self.channels.len()).filter(|&index| observer::is_due(tick, index)) {
            let Some(config) = &self.config else { return };
            let context = TickContext { now_us, system: &config.system, supply_pa: self.supply.pressure_pa() };
            let (Some(channel), Some(channel_config), Some(&code)) =
                (self.channels.get_mut(index), config.channels.get(index), inputs.pressure.get(index))
            else {
                return;
            };
            if !is_watched {
                channel.believe();
                continue;
            }
            let pressure_pa = channel.pressure_pa() as i32;
            if let Some(code) = channel.observe(&context, channel_config, code) {
                self.fault(now_us, index as u8, code, pressure_pa);
            }
        }
    }

    fn watch_supply(&mut self, now_us: u64) {
        let Some(config) = &self.config else { return };
        let (pressure_pa, system) = (self.supply.pressure_pa(), &config.system);
        let running = self.state == DeviceState::Running;
        let low = self.supply_low.holds(running && pressure_pa < system.supply_min_pa, SUPPLY_LOW_TICKS);
        let high = self.supply_high.holds(pressure_pa > system.supply_max_pa, SUPPLY_HIGH_TICKS);
        if low {
            self.fault(now_us, SYSTEM_CHANNEL, FaultCode::SupplyLow, pressure_pa as i32);
        }
        if high {
            self.fault(now_us, SYSTEM_CHANNEL, FaultCode::SupplyHigh, pressure_pa as i32);
        }
    }

    /// Not in Faulted: an emergency stop may cut the valves' supply too, and is the fault to report then.
    fn watch_valve_supply(&mut self, now_us: u64) {
        let low = self.state != DeviceState::Faulted && self.lacks_valve_voltage();
        if !self.valve_supply_low.holds(low, VALVE_SUPPLY_LOW_TICKS) {
            return;
        }
        let (code, value) = (FaultCode::ValveSupplyLow, i32::from(self.valve_supply_mv));
        if self.state == DeviceState::Idle {
            // Not a latching fault: the voltage may still come.
            self.faults.raise(Occurrence::system(now_us, code, value));
        } else {
            self.fault(now_us, SYSTEM_CHANNEL, code, value);
        }
    }

    /// A lost link lets the buffer run out; then it is held, ramped down after the hold time, or vented at once: as configured.
    fn watch_link(&mut self, now_us: u64) {
        let Some(config) = &self.config else { return };
        let silence_us = self.link.silence_us(now_us);
        let active = matches!(self.state, DeviceState::Running | DeviceState::Holding);
        if !active || silence_us <= u64::from(config.system.link_timeout_us) {
            return;
        }
        let at_once = config.system.link_loss_policy == LinkLossPolicy::Vent;
        self.fault(now_us, SYSTEM_CHANNEL, FaultCode::LinkLost, i32::try_from(silence_us).unwrap_or(i32::MAX));
        if self.state == DeviceState::Holding && (at_once || self.is_hold_time_over(now_us)) {
            self.apply(now_us, Event::Vent);
            self.vent_at_once = at_once;
        }
    }

    /// Begins at the start time; holds when the last knot has come.
    fn follow_setpoints(&mut self, now_us: u64) {
        if self.start_us.is_some_and(|start_us| now_us >= start_us) {
            self.start_us = None;
            if self.obstacle_to_start().is_none() && self.apply(now_us, Event::Start) {
                self.faults.forget(FaultCode::SetpointsExhausted);
                self.queue.resume();
            }
        }
        if self.state != DeviceState::Running {
            return;
        }
        self.outputs = self.queue.advance(now_us).unwrap_or(self.outputs);
        if self.queue.is_exhausted() {
            let next_index = i32::try_from(self.queue.next_index()).unwrap_or(i32::MAX);
            self.fault(now_us, SYSTEM_CHANNEL, FaultCode::SetpointsExhausted, next_index);
            self.apply(now_us, Event::Hold);
        }
    }

    /// A fault that forbids starting: a latched one, too little air or voltage in a supply, an empty buffer.
    pub(crate) fn obstacle_to_start(&self) -> Option<FaultCode> {
        let supply_min_pa = self.config.as_ref().map_or(0.0, |config| config.system.supply_min_pa);
        let low = (self.supply.pressure_pa() < supply_min_pa).then_some(FaultCode::SupplyLow);
        let empty = self.queue.is_exhausted().then_some(FaultCode::SetpointsExhausted);
        let dead = self.lacks_valve_voltage().then_some(FaultCode::ValveSupplyLow);
        self.faults.blocks_start().or(dead).or(low).or(empty)
    }

    fn watch_venting(&mut self, now_us: u64) {
        let count = self.config.as_ref().map_or(0, |config| config.channels.len());
        let mut channels = self.channels.iter().take(count);
        let done = if self.vent_at_once {
            // All vents are open; the longest relief is long enough.
            now_us.saturating_sub(self.state_since_us) >= crate::relief::OPEN_MAX_US
        } else {
            channels.all(|channel| channel.is_relieved(now_us))
        };
        if self.state == DeviceState::Venting && done {
            self.apply(now_us, Event::Vented);
        }
    }

    /// From idle to ready once all sensors are plausible and their zeros hold.
    fn watch_readiness(&mut self, now_us: u64) {
        if self.state != DeviceState::Idle || self.config.is_none() {
            return;
        }
        // Without voltage the vents stay closed, and air may be left in a chamber: its reading is not the zero.
        if !self.has_plausible_sensors() || self.lacks_valve_voltage() {
            return;
        }
        if self.zeros != Zeros::Checked {
            self.check_zeros(now_us);
        }
        if self.zeros == Zeros::Checked && !self.stop_pressed {
            self.apply(now_us, Event::SensorsReady);
        }
    }

    fn check_zeros(&mut self, now_us: u64) {
        let Some(config) = &self.config else { return };
        let taken = self.zeros == Zeros::Unknown;
        let channels = self.channels.iter_mut().zip(&config.channels);
        let mut checks = channels.map(|(channel, _)| channel.check_zero(&config.system, taken));
        // All channels have taken the same number of samples, so all means come in the same tick.
        let mut worst = None;
        let mut finished = true;
        for (index, check) in checks.by_ref().enumerate() {
            match check {
                Some(Ok(())) => {}
                Some(Err(offset_pa)) => {
                    worst.get_or_insert((index as u8, offset_pa as i32));
                }
                None => finished = false,
            }
        }
        match worst {
            // Not a latching fault: air may still leave, and idle allows it.
            Some((channel, value)) => {
                let code = FaultCode::SensorImplausible;
                self.faults.raise(Occurrence { time_us: now_us, code, channel, value });
            }
            None if finished => self.zeros = Zeros::Checked,
            None => {}
        }
    }
}
