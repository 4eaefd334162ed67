//! A device behind a port: whatever it does, only its messages tell.

use std::io;

use softlimb_sim::plant::Truth;

use super::recording::Bench;
use super::tape::Tape;
use crate::link::Transport;

/// A port whose bytes are kept for the log.
pub(super) struct Unobserved<T> {
    port: T,
    tape: Tape,
}

impl<T> Unobserved<T> {
    pub(super) fn new(port: T) -> Self {
        Self { port, tape: Tape::recording() }
    }
}

impl<T: Transport> Bench for Unobserved<T> {
    fn truth_at(&self, _device_us: u64) -> Option<Truth> {
        None
    }

    fn tape(&mut self) -> &mut Tape {
        &mut self.tape
    }
}

impl<T: Transport> Transport for Unobserved<T> {
    fn now_us(&self) -> u64 {
        self.port.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.send(bytes)?;
        self.tape.sent(self.port.now_us(), bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        let before = into.len();
        self.port.receive(into)?;
        self.tape.received(self.port.now_us(), &into[before..]);
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        self.port.wait_until(deadline_us);
    }
}
