//! The simulated device with an observer beside it: what a camera and a gauge in the chamber would see.

use std::collections::VecDeque;
use std::io;

use softlimb_sim::plant::Truth;
use softlimb_sim::{EmulatorError, Processor, SimulatedMcu};

use super::recording::Bench;
use super::tape::Tape;
use crate::link::Transport;
use crate::record::{CoilPulse, DeviceTick};

/// Ticks the observer remembers: longer than any telemetry message takes to arrive.
const MEMORY: usize = 256;

/// A simulated device whose truth is kept at every tick, so that a message that arrives later meets the truth of its own time.
pub(super) struct Observed {
    device: SimulatedMcu<Box<dyn Processor>>,
    seen: VecDeque<(u64, Truth)>,
    tape: Tape,
}

impl Observed {
    pub(super) fn new(device: SimulatedMcu<Box<dyn Processor>>) -> Self {
        Self { device, seen: VecDeque::with_capacity(MEMORY), tape: Tape::default() }
    }

    /// The same for a run with a log.
    pub(super) fn recording(device: SimulatedMcu<Box<dyn Processor>>) -> Self {
        Self { tape: Tape::recording(), ..Self::new(device) }
    }

    /// Why the device does not run any more, if it does not.
    pub(super) fn take_failure(&mut self) -> Option<EmulatorError> {
        self.device.take_failure()
    }

    fn look(&mut self) {
        let time_us = self.device.device_time_us();
        if self.seen.back().is_some_and(|(last, _)| *last == time_us) {
            return;
        }
        if self.seen.len() == MEMORY {
            self.seen.pop_front();
        }
        self.seen.push_back((time_us, self.device.truth()));
        self.tape.tick(latest_tick(&self.device));
    }
}

impl Bench for Observed {
    /// The truth at a device time, if it is remembered.
    fn truth_at(&self, device_us: u64) -> Option<Truth> {
        let index = self.seen.binary_search_by_key(&device_us, |(time_us, _)| *time_us).ok()?;
        Some(self.seen[index].1.clone())
    }

    fn tape(&mut self) -> &mut Tape {
        &mut self.tape
    }

    fn is_at_pins(&self) -> bool {
        self.device.processor().is_at_pins()
    }
}

impl Transport for Observed {
    fn now_us(&self) -> u64 {
        Transport::now_us(&self.device)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.tape.sent(Transport::now_us(&self.device), bytes);
        self.device.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        let before = into.len();
        self.device.receive(into)?;
        self.tape.received(Transport::now_us(&self.device), &into[before..]);
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        while !self.device.is_readable() && Transport::now_us(&self.device) < deadline_us {
            let tick_us = self.device.next_tick_us().min(deadline_us);
            self.device.advance_to(tick_us);
            self.look();
        }
    }
}

/// Inputs and outputs of the latest tick.
fn latest_tick(device: &SimulatedMcu<Box<dyn Processor>>) -> DeviceTick {
    let (inputs, outputs) = (device.inputs(), device.outputs());
    let codes = inputs.pressure.iter().take(device.channels()).chain([&inputs.supply]);
    let energized = (0..).zip(outputs.valves).filter(|(_, pulse)| pulse.fill_us > 0 || pulse.vent_us > 0);
    let pulse = |(channel, pulse): (u8, softlimb_sim::ValvePulse)| CoilPulse {
        channel,
        fill_us: pulse.fill_us,
        vent_us: pulse.vent_us,
    };
    DeviceTick {
        device_us: inputs.now_us,
        codes: codes.map(|code| code.0).collect(),
        stop_pressed: inputs.emergency_stop,
        supply_open: outputs.supply_open,
        pump_duty: outputs.pump_duty,
        outputs: outputs.digital.bits(),
        pulses: energized.map(pulse).collect(),
    }
}
