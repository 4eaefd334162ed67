//! `softlimb recover`: recovers a log that was cut off.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, Outcome, note, warn};
use softlimb_rig::record::recover;

/// Recover a log that was cut off or damaged, as a file that any reader opens
#[derive(Args)]
#[command(
    after_help = "A run that was killed leaves run.mcap.partial. The new file has its closed chunks, and of the chunk that was open all\n\
                  messages up to the last sample. A damaged chunk is left out. The old file stays. Exit code 3 tells of a loss.\n\n\
                  Example: softlimb recover out/single-bending/run.mcap.partial -o recovered.mcap"
)]
pub(super) struct Recover {
    /// The log (MCAP)
    log: PathBuf,
    /// The new file [default: beside the log, as NAME.recovered.mcap]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Recover {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let out = self.out.clone().unwrap_or_else(|| beside(&self.log));
        if out.exists() {
            let out = out.display();
            return Err(Failure::new(format!("{out} is there already: give another file with --out")));
        }
        let found = recover(&self.log, &out).map_err(Failure::new)?;
        note(&format!("wrote {}: {} messages of {} closed chunks", out.display(), found.messages, found.chunks));
        let losses = [
            (found.unchecked > 0).then(|| {
                format!("{} messages more are of a chunk that was open: no checksum covers them", found.unchecked)
            }),
            (found.chunks_damaged > 0).then(|| format!("{} damaged chunks are left out", found.chunks_damaged)),
            (!found.was_finished).then(|| "the run was not finished".to_owned()),
        ];
        Ok(warn(&losses.into_iter().flatten().collect::<Vec<_>>()))
    }
}

/// `run.mcap.partial` and `run.mcap` become `run.recovered.mcap`.
fn beside(log: &Path) -> PathBuf {
    let name = log.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let name = name.strip_suffix(".partial").unwrap_or(&name);
    log.with_file_name(format!("{}.recovered.mcap", name.strip_suffix(".mcap").unwrap_or(name)))
}
