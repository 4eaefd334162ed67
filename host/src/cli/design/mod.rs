//! `softlimb design`: a limb, its actuators, or a bundle of actuators.

mod actuators;
mod bundle;
mod candidates;
mod limb;
mod loaded;

use clap::{Args, Subcommand};
use softlimb_limb::fabricate::{Settings, advice};
use softlimb_scene::Scene;

pub use loaded::refused;

use super::{Failure, Outcome, note, warn};

/// Design a limb for a scene, actuators by eq. (14) of the paper, or a bundle by eq. (18)
#[derive(Args)]
#[command(after_help = "Examples:\n  softlimb design limb scenes/open/group-a.toml --out group-a.toml\n  \
                  softlimb design actuators reach.json --json\n  softlimb design bundle forces.json --json")]
pub(super) struct Design {
    #[command(subcommand)]
    mode: Mode,
}

#[derive(Subcommand)]
enum Mode {
    Limb(limb::LimbDesign),
    Actuators(actuators::Actuators),
    Bundle(bundle::Bundle),
}

impl Design {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.mode {
            Mode::Limb(mode) => mode.run(),
            Mode::Actuators(mode) => mode.run(),
            Mode::Bundle(mode) => mode.run(),
        }
    }
}

/// States warnings, and what `fabricate` says of the windings, which the search does not choose.
fn windings(designed: &Scene, warnings: &[String]) -> Outcome {
    let outcome = warn(warnings);
    for text in advice(designed, &Settings::default()) {
        note(&format!("warning: {text}"));
    }
    outcome
}
