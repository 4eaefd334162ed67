//! The simulated device as a port.

use std::io;

use softlimb_sim::{Processor, SimulatedMcu};

use super::transport::Transport;

impl<P: Processor> Transport for SimulatedMcu<P> {
    fn now_us(&self) -> u64 {
        SimulatedMcu::now_us(self)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write(bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        self.read(into);
        Ok(())
    }

    /// Wakes at ticks of the device only, as a host wakes at its own grain: a wake for every byte would be neither real nor fast.
    fn wait_until(&mut self, deadline_us: u64) {
        while !self.is_readable() && SimulatedMcu::now_us(self) < deadline_us {
            self.advance_to(self.next_tick_us().min(deadline_us));
        }
    }
}
