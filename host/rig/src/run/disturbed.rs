//! A run over a link that goes wrong on purpose.

use softlimb_sim::plant::Truth;

use super::recording::{Bench, Traffic};
use crate::link::{DisturbedLink, LinkFaults};

/// A device behind a link with faults; without them the link is the port itself.
pub(super) fn disturbed<B: Bench>(device: B, faults: Option<LinkFaults>, seed: u64) -> DisturbedLink<B> {
    DisturbedLink::new(device, faults.unwrap_or(LinkFaults::NONE), seed)
}

impl<B: Bench> Bench for DisturbedLink<B> {
    fn truth_at(&self, device_us: u64) -> Option<Truth> {
        self.port().truth_at(device_us)
    }

    fn traffic(&self) -> Traffic {
        self.port().traffic()
    }
}
