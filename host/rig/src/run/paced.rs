//! Paces a simulated device by this computer's clock, for an operator who watches it.

use std::io;
use std::thread;
use std::time::{Duration, Instant};

use softlimb_sim::plant::Truth;

use super::recording::Bench;
use super::tape::Tape;
use super::timed_fault::TimedFault;
use crate::link::Transport;

/// Lag behind the clock above which the device stops catching up, us.
const LAG_MAX_US: u64 = 250_000;

/// A device that never runs ahead of the clock.
pub(super) struct Paced<B> {
    device: B,
    began: Instant,
    start_us: u64,
}

impl<B: Bench> Paced<B> {
    pub(super) fn new(device: B) -> Self {
        let start_us = device.now_us();
        Self { device, began: Instant::now(), start_us }
    }

    /// The device.
    pub(super) fn device_mut(&mut self) -> &mut B {
        &mut self.device
    }

    fn clock_us(&self) -> u64 {
        self.start_us + self.began.elapsed().as_micros() as u64
    }
}

impl<B: Bench> Bench for Paced<B> {
    fn truth_at(&self, device_us: u64) -> Option<Truth> {
        self.device.truth_at(device_us)
    }

    fn tape(&mut self) -> &mut Tape {
        self.device.tape()
    }

    fn armed(&mut self, start_us: u64) {
        self.device.armed(start_us);
    }

    fn peak_chamber_pa(&self) -> Vec<f64> {
        self.device.peak_chamber_pa()
    }

    fn is_at_pins(&self) -> bool {
        self.device.is_at_pins()
    }

    fn break_now(&mut self, fault: TimedFault) -> Result<(), String> {
        self.device.break_now(fault)
    }
}

impl<B: Bench> Transport for Paced<B> {
    fn now_us(&self) -> u64 {
        self.device.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.device.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        self.device.receive(into)
    }

    fn wait_until(&mut self, deadline_us: u64) {
        self.device.wait_until(deadline_us);
        let (now_us, clock_us) = (self.device.now_us(), self.clock_us());
        if clock_us > now_us + LAG_MAX_US {
            (self.began, self.start_us) = (Instant::now(), now_us);
        }
        thread::sleep(Duration::from_micros(now_us.saturating_sub(clock_us)));
    }
}
