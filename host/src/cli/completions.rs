//! `softlimb completions`: completion of words and options in a shell.

use clap::Args;
use clap_complete::{Shell, generate};

use super::{Failure, Outcome, say};

/// Print the script that completes words and options in a shell
#[derive(Args)]
#[command(after_help = "Example: softlimb completions bash")]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let mut script = Vec::new();
        generate(self.shell, &mut super::command(), "softlimb", &mut script);
        say(&String::from_utf8_lossy(&script))?;
        Ok(Outcome::Done)
    }
}
