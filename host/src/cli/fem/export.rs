//! `softlimb fem export`: write a deck.

use std::path::PathBuf;

use clap::Args;

use super::subject::{Arguments, Asked, describe, told};
use crate::cli::{Failure, Outcome, note, say};
use softlimb_fea::solid::{Deck, Model};

/// Write a finite element deck for CalculiX and Abaqus
#[derive(Args)]
#[command(
    after_help = "Writes NAME.inp (CalculiX: ccx NAME), NAME-abaqus.inp (Abaqus) and NAME-model.inc, which both include.\n\
                  Examples:\n  softlimb fem export scenes/pick-and-place-a.toml --module elbow --bundle\n  \
                  softlimb fem export finger.json --fibers threads"
)]
pub(super) struct Export {
    #[command(flatten)]
    arguments: Arguments,
    /// Folder for the files [default: out/fem]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Export {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let Asked { name, subject, options, pressures_pa } = self.arguments.read()?;
        let model = Model::new(&subject, &options).map_err(told)?;
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from("out").join("fem"));
        let deck = Deck::new(&model, &name, &pressures_pa)?;
        deck.write(&out)?;
        let files = deck.files().map(|(name, _)| out.join(name).display().to_string());
        say(&format!("{}\n{}", describe(&model), files.join("\n")))?;
        model.warnings().iter().for_each(|warning| note(&format!("warning: {warning}")));
        Ok(if model.warnings().is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}
