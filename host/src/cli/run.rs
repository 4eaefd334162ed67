//! `softlimb run`: check, plan, stream to the simulated MCU, record, report.

use clap::Args;

use super::{Failure, Outcome};

/// Run a scene: check, plan, stream to the simulated MCU, record, report
#[derive(Args)]
pub(super) struct Run {}

impl Run {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        Err(Failure::new("not wired yet"))
    }
}
