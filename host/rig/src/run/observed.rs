//! The simulated device with an observer beside it: what a camera and a gauge in the chamber would see.

use std::collections::VecDeque;
use std::io;

use softlimb_sim::plant::Truth;
use softlimb_sim::{EmulatorError, Processor, SimulatedMcu};

use super::recording::{Bench, Traffic};
use crate::link::Transport;

/// Ticks the observer remembers: longer than any telemetry message takes to arrive.
const MEMORY: usize = 256;

/// A simulated device whose truth is kept at every tick, so that a message that arrives later meets the truth of its own time.
pub(super) struct Observed {
    device: SimulatedMcu<Box<dyn Processor>>,
    seen: VecDeque<(u64, Truth)>,
    traffic: Traffic,
}

impl Observed {
    pub(super) fn new(device: SimulatedMcu<Box<dyn Processor>>) -> Self {
        Self { device, seen: VecDeque::with_capacity(MEMORY), traffic: Traffic::default() }
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
    }
}

impl Bench for Observed {
    /// The truth at a device time, if it is remembered.
    fn truth_at(&self, device_us: u64) -> Option<Truth> {
        let index = self.seen.binary_search_by_key(&device_us, |(time_us, _)| *time_us).ok()?;
        Some(self.seen[index].1.clone())
    }

    fn traffic(&self) -> Traffic {
        self.traffic
    }
}

impl Transport for Observed {
    fn now_us(&self) -> u64 {
        Transport::now_us(&self.device)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.traffic.sent += bytes.len() as u64;
        self.device.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        let before = into.len();
        self.device.receive(into)?;
        self.traffic.received += (into.len() - before) as u64;
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
