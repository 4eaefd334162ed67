//! `softlimb fea export`: write a deck.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::subject::{Arguments, Asked, describe};
use crate::cli::shared::show;
use crate::cli::{Failure, Outcome, warn};
use softlimb_fea::solid::{Deck, Model};

/// Write a finite element deck for CalculiX and Abaqus
#[derive(Args)]
#[command(
    after_help = "Writes NAME.inp (CalculiX: ccx NAME), NAME-abaqus.inp (Abaqus) and NAME-model.inc, which both include.\n\
                  Examples:\n  softlimb fea export scenes/pick-and-place-a.toml --module elbow --bundle --around 8 --along 20\n  \
                  softlimb fea export finger.json --fibers threads"
)]
pub(super) struct Export {
    #[command(flatten)]
    arguments: Arguments,
    /// Folder for the files [default: out/fea]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    name: &'a str,
    nodes: usize,
    elements: usize,
    files: &'a [String],
    warnings: &'a [String],
}

impl Export {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let Asked { name, subject, options, pressures_pa } = self.arguments.read()?;
        let model = Model::new(&subject, &options).map_err(|error| self.arguments.refused(error))?;
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from("out").join("fea"));
        let deck = Deck::new(&model, &name, &pressures_pa)?;
        deck.write(&out)?;
        let files = deck.files().map(|(name, _)| out.join(name).display().to_string());
        let (elements, warnings) = (model.mesh().elements.len(), model.warnings());
        let printed = Printed { name: &name, nodes: model.nodes(), elements, files: &files, warnings };
        show(self.json, &printed, || format!("{}\n{}", describe(&model), files.join("\n")))?;
        Ok(warn(warnings))
    }
}
