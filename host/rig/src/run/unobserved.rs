//! A device behind a port: whatever it does, only its messages tell.

use std::io;

use softlimb_sim::plant::Truth;

use super::recording::{Bench, Traffic};
use crate::link::Transport;

/// A port whose bytes are counted.
pub(super) struct Unobserved<T> {
    port: T,
    traffic: Traffic,
}

impl<T> Unobserved<T> {
    pub(super) fn new(port: T) -> Self {
        Self { port, traffic: Traffic::default() }
    }
}

impl<T: Transport> Bench for Unobserved<T> {
    fn truth_at(&self, _device_us: u64) -> Option<Truth> {
        None
    }

    fn traffic(&self) -> Traffic {
        self.traffic
    }
}

impl<T: Transport> Transport for Unobserved<T> {
    fn now_us(&self) -> u64 {
        self.port.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.send(bytes)?;
        self.traffic.sent += bytes.len() as u64;
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        let before = into.len();
        self.port.receive(into)?;
        self.traffic.received += (into.len() - before) as u64;
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        self.port.wait_until(deadline_us);
    }
}
