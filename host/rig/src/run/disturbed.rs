//! A run over a link that goes wrong on purpose.

use softlimb_sim::plant::Truth;

use super::recording::Bench;
use super::tape::Tape;
use super::timed_fault::TimedFault;
use crate::link::{DisturbedLink, LinkFaults};

/// A device behind a link with faults; without them the link is the port itself.
pub(super) fn disturbed<B: Bench>(device: B, faults: Option<LinkFaults>, seed: u64) -> DisturbedLink<B> {
    DisturbedLink::new(device, faults.unwrap_or(LinkFaults::NONE), seed)
}

impl<B: Bench> Bench for DisturbedLink<B> {
    fn truth_at(&self, device_us: u64) -> Option<Truth> {
        self.port().truth_at(device_us)
    }

    fn tape(&mut self) -> &mut Tape {
        self.port_mut().tape()
    }

    fn armed(&mut self, start_us: u64) {
        self.port_mut().armed(start_us);
    }

    fn peak_chamber_pa(&self) -> Vec<f64> {
        self.port().peak_chamber_pa()
    }

    fn is_at_pins(&self) -> bool {
        self.port().is_at_pins()
    }

    fn break_now(&mut self, fault: TimedFault) -> Result<(), String> {
        self.port_mut().break_now(fault)
    }
}
