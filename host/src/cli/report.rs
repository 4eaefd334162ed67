//! `softlimb report`: the report of a recorded run.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, Outcome};
use crate::record;
use crate::report;

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
        write_whole(&out, report::html(&log).as_bytes())?;
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

/// Writes a file so that under its name there is the whole of it or what was there before.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    let partial = path.with_file_name(name);
    let written = fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, path));
    written.map_err(|error| {
        // The partial file is of no use to anyone; that it cannot be removed adds nothing to the message.
        let _ = fs::remove_file(&partial);
        Failure::file("write", path, &error)
    })
}
