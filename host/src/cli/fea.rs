//! `softlimb fea`: finite elements.

mod calibrate;
mod compare;
mod export;
mod run;
mod subject;

pub use compare::{Calculix, as_json, text};

use clap::{Args, Subcommand};

use super::{Failure, Outcome};
use softlimb_fea::solid::FemError;

/// Finite elements: compare them with the model, write decks for CalculiX and Abaqus, run CalculiX, calibrate the model
#[derive(Args)]
#[command(after_help = "Options of meshes: docs/guide/finite-elements.md\n\nExamples:\n  \
                  softlimb fea compare scenes/pick-and-place-a.toml\n  \
                  softlimb fea export scenes/single-bending.toml --fibers threads\n  \
                  softlimb fea run scenes/pick-and-place-a.toml --module shoulder --pressure 60kPa\n  \
                  softlimb fea calibrate scenes/pick-and-place-a.toml --thread 772,3,0.178")]
pub(super) struct Fea {
    #[command(subcommand)]
    mode: Mode,
}

#[derive(Subcommand)]
enum Mode {
    Compare(compare::Compare),
    Export(export::Export),
    Run(run::Run),
    Calibrate(calibrate::Calibrate),
}

impl Fea {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.mode {
            Mode::Compare(mode) => mode.run(),
            Mode::Export(mode) => mode.run(),
            Mode::Run(mode) => mode.run(),
            Mode::Calibrate(mode) => mode.run(),
        }
    }
}

impl From<FemError> for Failure {
    fn from(error: FemError) -> Self {
        Self::new(error)
    }
}
