//! `softlimb payload`: the load that a limb can hold, does hold, and tracks under.

mod capacity;
mod estimate;
mod report;
mod track;

use clap::{Args, Subcommand};

use super::{Failure, Outcome};

/// Payload of a limb: its largest loads, an estimate from measured tip positions, and tracking under loads
#[derive(Args)]
#[command(after_help = "Terms and limits: docs/explanation/payload.md\n\nExamples:\n  \
                  softlimb payload capacity scenes/pick-and-place-a.toml --svg push.svg\n  \
                  softlimb payload estimate scenes/loaded/carry-hanging.toml --data tips.csv\n  \
                  softlimb payload track scenes/loaded/carry-hanging.toml --loads 5,10,15,20")]
pub(super) struct Payload {
    #[command(subcommand)]
    mode: Mode,
}

#[derive(Subcommand)]
enum Mode {
    Capacity(capacity::CapacityMode),
    Estimate(estimate::Estimate),
    Track(track::Track),
}

impl Payload {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.mode {
            Mode::Capacity(mode) => mode.run(),
            Mode::Estimate(mode) => mode.run(),
            Mode::Track(mode) => mode.run(),
        }
    }
}
