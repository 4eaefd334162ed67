//! `softlimb report`: the report of a recorded run.

use std::path::{Path, PathBuf};

use clap::Args;

use super::shared::show;
use super::{Failure, Outcome};
use crate::results::bend::rows;
use crate::results::{RunSummary, recorded_limb};
use softlimb_files::write_whole;
use softlimb_rig::record;
use softlimb_rig::report;
use softlimb_rig::run;

/// Write the report of a recorded run
#[derive(Args)]
#[command(after_help = "Example: softlimb report out/pick-and-place-a/run.mcap")]
pub(super) struct Report {
    /// The recorded run (MCAP)
    log: PathBuf,
    /// The page [default: beside the log]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write static figures, without scripts
    #[arg(long = "static")]
    is_static: bool,
    /// Write the run as an animated picture (SVG), too
    #[arg(long, value_name = "FILE")]
    motion: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

impl Report {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let log = record::read(&self.log).map_err(Failure::new)?;
        let out = self.out.clone().unwrap_or_else(|| self.log.with_extension("html"));
        if same_file(&out, &self.log) {
            let log = self.log.display();
            return Err(Failure::new(format!("the report would replace the log {log}: give another file with --out")));
        }
        let write = if self.is_static { run::write_still_report } else { run::write_report };
        if let Some(file) = self.motion.as_ref().filter(|file| same_file(file, &self.log) || **file == out) {
            let file = file.display();
            return Err(Failure::new(format!("the picture would replace {file}: give another file with --motion")));
        }
        write(&out, &log).map_err(Failure::new)?;
        let summary = report::summary(&log);
        let (limb, incomplete) = (recorded_limb(&log), log.incomplete.iter().cloned().collect());
        let result = RunSummary::new(&summary, limb.as_ref(), Vec::new(), incomplete);
        show(self.json, &result, || summary.table())?;
        if !self.json {
            limb.iter().flat_map(rows).for_each(|row| super::note(row.trim_start()));
        }
        super::note(&format!("wrote {}", out.display()));
        if let Some(file) = &self.motion {
            let picture = report::motion_svg(&log).ok_or_else(|| {
                Failure::new(
                    "no picture: the log has no shape of the limb. It was written by an earlier version, or no observer saw the limb",
                )
            })?;
            write_whole(file, &picture).map_err(Failure::new)?;
            super::note(&format!("wrote {}", file.display()));
        }
        Ok(super::warn(&result.warnings))
    }
}

/// Whether both paths lead to one file that exists.
fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
