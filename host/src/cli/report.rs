//! `softlimb report`: the report of a recorded run.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, Outcome};
use crate::record;
use crate::report;
use crate::run;

/// Write the report of a recorded run
#[derive(Args)]
#[command(after_help = "Example: softlimb report out/pick-and-place-a/run.mcap")]
pub(super) struct Report {
    /// The recorded run (MCAP)
    log: PathBuf,
    /// Where the HTML goes; default: beside the log
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

impl Report {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let log = record::read(&self.log).map_err(Failure::new)?;
        let out = self.out.clone().unwrap_or_else(|| self.log.with_extension("html"));
        run::write_report(&out, &log).map_err(Failure::new)?;
        let summary = report::summary(&log);
        if self.json {
            println!("{}", serde_json::json!(summary));
        } else {
            println!("{}", summary.table());
        }
        eprintln!("wrote {}", out.display());
        if let Some(missing) = &log.incomplete {
            eprintln!("warning: {missing}");
            return Ok(Outcome::DoneWithWarnings);
        }
        Ok(Outcome::Done)
    }
}
