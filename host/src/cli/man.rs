//! `softlimb man`: manual pages from the grammar of the command.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, Outcome};
use softlimb_files::make_folder;

/// Write the manual pages of the command, one a verb
#[derive(Args)]
#[command(after_help = "Example: softlimb man ~/.local/share/man/man1")]
pub(super) struct Man {
    /// Folder for softlimb.1, softlimb-run.1, ...
    folder: PathBuf,
}

impl Man {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        make_folder(&self.folder).map_err(Failure::new)?;
        // `help` repeats the pages of the others.
        let command = super::command().disable_help_subcommand(true);
        clap_mangen::generate_to(command, &self.folder)
            .map_err(|error| Failure::new(format!("cannot write to {}: {error}", self.folder.display())))?;
        Ok(Outcome::Done)
    }
}
