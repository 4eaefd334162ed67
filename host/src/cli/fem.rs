//! `softlimb fem`: three-dimensional finite elements.

mod export;
mod run;
mod subject;

use clap::{Args, Subcommand};

use super::{Failure, Outcome};
use crate::fem::FemError;

/// Finite elements in three dimensions: write decks for CalculiX and Abaqus, run CalculiX
#[derive(Args)]
#[command(after_help = "Examples:\n  softlimb fem export scenes/single-bending.toml --fibers threads\n  \
                  softlimb fem run scenes/pick-and-place-a.toml --module shoulder --pressure-kpa 60")]
pub(super) struct Fem {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Export(export::Export),
    Run(run::Run),
}

impl Fem {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.what {
            What::Export(export) => export.run(),
            What::Run(run) => run.run(),
        }
    }
}

impl From<FemError> for Failure {
    fn from(error: FemError) -> Self {
        Self::new(error)
    }
}
