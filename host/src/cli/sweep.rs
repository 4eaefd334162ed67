//! `softlimb sweep`: runs of a study.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;

use super::interrupt::interrupt;
use super::shared::{bar, threads};
use super::{Failure, Outcome, note, warn};
use crate::sweep::{Shard, SweepError, Table, run_rows};
use softlimb_scene as scene;

/// Run scenes with varied parameters on many simulated limbs, or have the limbs learn, and tabulate the results
#[derive(Args)]
#[command(
    after_help = "The study: docs/reference/study.md. Rows do not depend on threads or shards. The same command continues an interrupted sweep.\n\n\
                  Examples:\n  softlimb sweep scenes/studies/finger.toml\n  \
                  softlimb sweep scenes/studies/finger.toml --shard 1/4 --out part-1.csv\n  \
                  softlimb sweep scenes/studies/finger.toml --merge part-1.csv part-2.csv part-3.csv part-4.csv"
)]
pub(super) struct Sweep {
    /// The study file
    study: PathBuf,
    /// The table [default: the name of the study, as .csv, in the current folder]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Run one of N equal parts of the rows, for several machines
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "merge")]
    shard: Option<Shard>,
    /// Join the tables of all parts; nothing runs
    #[arg(long, value_name = "FILE", num_args = 1..)]
    merge: Vec<PathBuf>,
    /// Threads [default: one for each processor]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with = "merge")]
    threads: Option<u16>,
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        Self::new(error)
    }
}

impl Sweep {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let study = scene::load_study(&self.study)?;
        let out = self
            .out
            .clone()
            .unwrap_or_else(|| PathBuf::from(self.study.file_name().unwrap_or_default()).with_extension("csv"));
        // A table that is there is complete, or not opened.
        let was_complete = self.merge.is_empty() && out.exists();
        let table = if self.merge.is_empty() {
            let mut table = Table::open(&study, self.shard.unwrap_or(Shard::WHOLE), &out)?;
            self.run_missing(&study, &mut table)?;
            table
        } else {
            Table::merged(&study, &self.merge, &out)?
        };
        let ([rows, _], without_result) = (table.progress(), table.without_result());
        if was_complete {
            note(&format!("{} is complete: {rows} rows; remove it to run them again", out.display()));
        } else {
            table.finish()?;
            note(&format!("wrote {}: {rows} rows", out.display()));
        }
        Ok(match without_result {
            0 => Outcome::Done,
            count => warn(&[format!("{count} of {rows} rows have no result; the column `outcome` has the reason")]),
        })
    }

    fn run_missing(&self, study: &scene::Study, table: &mut Table) -> Result<(), Failure> {
        let cancel = interrupt()?;
        let missing: Vec<u64> = table.missing().collect();
        let [before, all] = table.progress();
        let bar = bar(all, "sweep");
        bar.set_position(before);
        let mut kept = Ok(());
        run_rows(study, &missing, threads(self.threads), &cancel, |row| {
            if kept.is_ok() {
                kept = table.add(row);
            }
            if kept.is_err() {
                cancel.store(true, Ordering::Relaxed);
            }
            bar.inc(1);
        });
        bar.finish_and_clear();
        kept?;
        let [rows, all] = table.progress();
        if rows == all {
            return Ok(());
        }
        let part = table.part();
        Err(Failure::new(format!(
            "interrupted: {} has {rows} of {all} rows, and the same command runs the others",
            part.display()
        )))
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
    match parts {
        Some((index, count)) if (1..=count).contains(&index) => Ok(Shard { index, count }),
        _ => Err("give part and number of parts, 1/4 to 4/4 for example".to_owned()),
    }
}
