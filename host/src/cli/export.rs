//! `softlimb export`: a log as tables or as JSON.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::shared::write;
use super::{Failure, Outcome, warn};
use softlimb_files::make_folder;
use softlimb_rig::export::{WholeLog, tables};
use softlimb_rig::record;

/// Write a log as tables of comma-separated values, one a topic, or as JSON
#[derive(Args)]
#[command(
    group = ArgGroup::new("form").args(["csv", "json"]).multiple(true).required(true),
    after_help = "Numbers are in SI units and read back exactly; the names of columns and fields end with the unit.\n\n\
                  Examples:\n  softlimb export out/pick-and-place-a/run.mcap --csv tables\n  \
                  softlimb export out/pick-and-place-a/run.mcap --json run.json"
)]
pub(super) struct Export {
    /// The recorded run (MCAP)
    log: PathBuf,
    /// Folder for the tables: telemetry.csv, setpoint.csv, ...
    #[arg(long, value_name = "DIR")]
    csv: Option<PathBuf>,
    /// File for the whole log as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Export {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let log = record::read(&self.log).map_err(Failure::new)?;
        let capture = record::read_capture(&self.log).map_err(Failure::new)?;
        if let Some(folder) = &self.csv {
            make_folder(folder).map_err(Failure::new)?;
            for table in tables(&log, &capture) {
                write(&folder.join(table.name).with_extension("csv"), &table.csv())?;
            }
        }
        if let Some(file) = &self.json {
            let whole = WholeLog { run: &log, capture: &capture };
            write(file, &serde_json::to_string(&whole).map_err(Failure::new)?)?;
        }
        Ok(warn(&log.incomplete.into_iter().collect::<Vec<_>>()))
    }
}
