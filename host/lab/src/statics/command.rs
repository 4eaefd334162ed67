//! `softlimb-lab statics`: the shipped loaded scenes by shooting, beside the product.

use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;
use softlimb::cli::{Failure, Outcome};

/// The program, which reads scenes and runs `softlimb statics` itself.
const PROGRAM: &str = "benches/statics/shooting.py";

/// Compare tip, sag, stiffness and load factor of the shipped loaded scenes with a shooting solution that has springs derived anew
#[derive(Args)]
#[command(after_help = "Needs Python 3.11 with numpy.\nExample: cargo xtask lab statics --python .venv/bin/python")]
pub(crate) struct Statics {
    /// The interpreter
    #[arg(long, value_name = "PATH", default_value = "python3")]
    python: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Statics {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let mut command = Command::new(&self.python);
        command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(PROGRAM)).args(self.json.then_some("--json"));
        let python = self.python.display();
        let status = command.status().map_err(|error| Failure::new(format!("--python {python}: {error}")))?;
        if status.success() {
            return Ok(Outcome::Done);
        }
        Err(Failure::new(format!("--python {python}: the comparison ended with {status}; it needs numpy")))
    }
}
