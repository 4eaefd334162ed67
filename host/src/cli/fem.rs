//! `softlimb fem`: finite elements.

mod calibrate;
mod compare;
mod export;
mod run;
mod subject;
mod values;

pub use compare::{Calculix, as_json, text};

use clap::{Args, Subcommand};

use super::{Failure, Outcome};
use softlimb_fea::solid::FemError;

/// Finite elements: write decks for CalculiX and Abaqus, run CalculiX, compare with the model, calibrate it
#[derive(Args)]
#[command(after_help = "Examples:\n  softlimb fem export scenes/single-bending.toml --fibers threads\n  \
                  softlimb fem run scenes/pick-and-place-a.toml --module shoulder --pressure-kpa 60\n  softlimb fem compare scenes/pick-and-place-a.toml")]
pub(super) struct Fem {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Export(export::Export),
    Run(run::Run),
    Compare(compare::Compare),
    Calibrate(calibrate::Calibrate),
}

impl Fem {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.what {
            What::Export(export) => export.run(),
            What::Run(run) => run.run(),
            What::Compare(compare) => compare.run(),
            What::Calibrate(calibrate) => calibrate.run(),
        }
    }
}

impl From<FemError> for Failure {
    fn from(error: FemError) -> Self {
        Self::new(error)
    }
}
