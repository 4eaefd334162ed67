//! Requests by hand: single valves, digital outputs, zeros.

use core::ops::RangeInclusive;

use softlimb_protocol::{DeviceState, FaultCode, ManualPulse, Outputs, PulseDirection, ResultCode, SetOutputs};

use crate::config::number;
use crate::controller::Controller;
use crate::dispatch::{Answer, OK, WRONG_STATE};
use crate::sensor::Zeros;
use crate::state::Event;
use crate::valve::Direction;

/// Coil times that a pulse by hand may have, us.
const PULSE_US: RangeInclusive<u32> = 1_000..=1_000_000;

/// The outputs that the device has no pin for, if any are on.
pub(crate) fn has_unknown(outputs: Outputs) -> bool {
    !Outputs::ALL.contains(outputs)
}

impl<const N: usize> Controller<N> {
    /// Opens one valve from the next tick on.
    pub(crate) fn manual_pulse(&mut self, now_us: u64, pulse: &ManualPulse) -> Answer {
        if !self.takes_hands() {
            return WRONG_STATE;
        }
        let index = usize::from(pulse.channel);
        if index >= self.channels.len() {
            return (ResultCode::OutOfRange, u32::from(number!(ManualPulse, "channel")));
        }
        let Some(direction) = pulse.direction.known() else {
            return (ResultCode::UnknownCode, u32::from(number!(ManualPulse, "direction")));
        };
        if !PULSE_US.contains(&pulse.duration_us) {
            return (ResultCode::OutOfRange, u32::from(number!(ManualPulse, "duration_us")));
        }
        let direction = match direction {
            PulseDirection::Fill => Direction::Fill,
            PulseDirection::Vent => Direction::Vent,
        };
        if direction == Direction::Fill {
            // A chamber under pressure is held: what watches over Holding watches over it. In Holding this changes nothing.
            self.apply(now_us, Event::Fill);
        }
        self.is_by_hand = true;
        if let Some(channel) = self.channels.get_mut(index) {
            channel.request(direction, pulse.duration_us);
        }
        OK
    }

    /// Switches the digital outputs from the next tick on.
    pub(crate) fn set_outputs(&mut self, request: &SetOutputs) -> Answer {
        if !self.takes_hands() {
            return WRONG_STATE;
        }
        if has_unknown(request.outputs) {
            return (ResultCode::UnknownCode, u32::from(number!(SetOutputs, "outputs")));
        }
        self.outputs = request.outputs;
        OK
    }

    /// Takes the zeros anew, in Idle, unless a chamber is under pressure by its sensor as it is.
    pub(crate) fn zero(&mut self, now_us: u64) -> Answer {
        let Some(config) = &self.config else { return WRONG_STATE };
        if self.state != DeviceState::Ready {
            return WRONG_STATE;
        }
        let limit_pa = config.system.sensor.zero_limit_pa();
        if self.channels.iter().any(|channel| channel.sensor().raw_pa().abs() > limit_pa) {
            return (ResultCode::WrongState, u32::from(FaultCode::SensorImplausible as u8));
        }
        self.zeros = Zeros::Unknown;
        self.apply(now_us, Event::Zero);
        OK
    }

    /// Whether nothing else moves the limb.
    fn takes_hands(&self) -> bool {
        matches!(self.state, DeviceState::Ready | DeviceState::Holding)
    }
}
