//! `softlimb device`: one device and its port.

mod serve;

use clap::{Args, Subcommand};

use super::{Failure, Outcome};

/// Talk to one device, or be one
#[derive(Args)]
#[command(after_help = "Example: softlimb device serve scenes/single-bending.toml")]
pub(super) struct Device {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Serve(serve::Serve),
}

impl Device {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.verb {
            Verb::Serve(verb) => verb.run(),
        }
    }
}
