//! A link that goes wrong on purpose: seeded faults around any port.
//!
//! A [`DisturbedLink`] hands on what a port carries, frame by frame, and hurts, loses, repeats, swaps or delays some of it. The host's
//! session and the device behind it are the very ones of an undisturbed run. Faults are those of serial lines: SPEC.md, section 1.

mod faults;
mod line;

pub use faults::{LinkFaultError, LinkFaults};
pub use line::Disturbances;

use std::io;

use softlimb_numerics::Random;

use super::transport::Transport;
use line::DisturbedLine;

/// A port with faults on the way to the device and back.
#[derive(Debug)]
pub struct DisturbedLink<T> {
    port: T,
    to_device: DisturbedLine,
    to_host: DisturbedLine,
    arrived: Vec<u8>,
}

impl<T: Transport> DisturbedLink<T> {
    /// The port with the same faults each way; equal seeds hurt equal frames.
    pub fn new(port: T, faults: LinkFaults, seed: u64) -> Self {
        let line = |stream| DisturbedLine::new(faults, Random::new(seed, stream));
        Self { port, to_device: line(0), to_host: line(1), arrived: Vec::new() }
    }

    /// The port.
    pub fn port(&self) -> &T {
        &self.port
    }

    /// The port, to be meddled with.
    pub fn port_mut(&mut self) -> &mut T {
        &mut self.port
    }

    /// The faults so far, to the device and back.
    pub fn disturbances(&self) -> [Disturbances; 2] {
        [self.to_device.disturbances(), self.to_host.disturbances()]
    }

    /// Hands on what the line to the device holds no longer.
    fn deliver(&mut self) -> io::Result<()> {
        let mut bytes = Vec::new();
        self.to_device.deliver(self.port.now_us(), &mut bytes);
        if bytes.is_empty() { Ok(()) } else { self.port.send(&bytes) }
    }
}

impl<T: Transport> Transport for DisturbedLink<T> {
    fn now_us(&self) -> u64 {
        self.port.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.to_device.take(self.port.now_us(), bytes);
        self.deliver()
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        self.deliver()?;
        self.arrived.clear();
        self.port.receive(&mut self.arrived)?;
        let now_us = self.port.now_us();
        self.to_host.take(now_us, &self.arrived);
        self.to_host.deliver(now_us, into);
        Ok(())
    }

    /// Wakes also when a stall of either line is over.
    fn wait_until(&mut self, deadline_us: u64) {
        let lines_us = self.to_device.due_us().into_iter().chain(self.to_host.due_us()).min();
        let now_us = self.port.now_us();
        self.port.wait_until(lines_us.map_or(deadline_us, |due_us| due_us.max(now_us + 1).min(deadline_us)));
    }
}
