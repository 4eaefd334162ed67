//! `softlimb-lab accuracy`: error against cost of the model.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use softlimb::cli::{Failure, Outcome, note, read, say};

use super as bench;
use super::{Accuracy as Measured, Doubt, Report, Settings};
use crate::published::Published;

/// Error against cost of every method, motion and scalar over a seeded set of actuators
#[derive(Args)]
#[command(
    after_help = "Times are relative to Newton's method from rest to 1e-10 on an extension actuator in double precision, \
                  measured in the same run.\n\
                  The published table: cargo xtask lab accuracy --instructions --mcu firmware/boards/mps2-an386/counts.tsv \
                  --tsv tests/golden/accuracy.tsv --svg docs/evidence/accuracy.svg --page docs/evidence/accuracy.md"
)]
pub(crate) struct Accuracy {
    /// Number of actuators
    #[arg(long, value_name = "N", default_value_t = bench::ACTUATORS as u32, value_parser = clap::value_parser!(u32).range(4..=100_000))]
    actuators: u32,
    /// Seed of the set of actuators
    #[arg(long, default_value_t = bench::SEED)]
    seed: u64,
    /// Count instructions and floating-point operations too (needs valgrind and objdump)
    #[arg(long)]
    instructions: bool,
    /// Add the counts of a microcontroller, as `cargo xtask model-image --record` writes them
    #[arg(long, value_name = "FILE")]
    mcu: Option<PathBuf>,
    #[command(flatten)]
    published: Published,
    /// Do the work that is counted, once
    #[arg(long, hide = true)]
    workload: bool,
}

impl Accuracy {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        if self.workload {
            return self.work();
        }
        let page = self.published.page(bench::PLACE)?;
        let mcu = self.mcu.as_deref().map(|file| read(file).map(|table| (file, table))).transpose()?;
        if let Some((file, table)) = &mcu {
            bench::join(&mut Report::default(), table).map_err(|error| Failure::file("use", file, &error))?;
        }
        let (mut report, mut outcome) = (self.measure(), Outcome::Done);
        if self.instructions {
            outcome = self.count(&mut report)?;
        }
        if let Some((file, table)) = mcu {
            bench::join(&mut report, &table).map_err(|error| Failure::file("use", file, &error))?;
        }
        self.published.show(|| table(&report), || report.table())?;
        // Picture and page show what the file says, to the digit.
        let report = Report::from_tsv(&report.tsv()).map_err(Failure::new)?;
        self.published.keep(|| report.tsv())?;
        self.published.draw(|| bench::picture(&report))?;
        page.map_or(Ok(()), |page| page.write(&bench::page(&report)))?;
        Ok(outcome)
    }

    fn measure(&self) -> Report {
        let bar = ProgressBar::new(0);
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let begin = Instant::now();
        let clock = || begin.elapsed().as_secs_f64();
        let settings = Settings { seed: self.seed, actuators: self.actuators as usize };
        let report = bench::accuracy(&settings, Some(&clock), |progress| {
            bar.set_length(progress.all as u64);
            bar.set_position(progress.done as u64);
        });
        bar.finish_and_clear();
        report
    }

    /// Counts instructions, in this program run anew. What is missing is a warning: the rest of the table stands.
    fn count(&self, report: &mut Report) -> Result<Outcome, Failure> {
        let missing = bench::missing_instruments();
        if missing.contains(&"valgrind") {
            note("warning: valgrind is not installed: instructions and floating-point operations are not counted");
            return Ok(Outcome::DoneWithWarnings);
        }
        let program =
            std::env::current_exe().map_err(|error| Failure::new(format!("cannot find this program: {error}")))?;
        let arguments = ["accuracy", "--workload", "--seed", &self.seed.to_string()].map(str::to_owned);
        bench::count(report, &program, &arguments).map_err(Failure::new)?;
        if missing.is_empty() {
            return Ok(Outcome::Done);
        }
        note("warning: objdump is not installed: floating-point operations are not counted");
        Ok(Outcome::DoneWithWarnings)
    }

    fn work(&self) -> Result<Outcome, Failure> {
        let mut lines = Vec::new();
        bench::workload(self.seed, |line| lines.push(line.to_owned()));
        say(&lines.join("\n"))?;
        Ok(Outcome::Done)
    }
}

#[derive(Serialize)]
struct Table<'a> {
    seed: u64,
    actuators: usize,
    answered: usize,
    reference: &'a Doubt,
    rows: Vec<Line<'a>>,
}

#[derive(Serialize)]
struct Line<'a> {
    problem: &'a str,
    method: &'a str,
    motion: &'a str,
    scalar: &'a str,
    #[serde(flatten)]
    accuracy: &'a Measured,
    time_ratio: Option<f64>,
    instructions: Option<f64>,
    flops: Option<f64>,
    mcu_instructions: Option<f64>,
    mcu_cycles: Option<f64>,
}

fn table(report: &Report) -> Table<'_> {
    let rows = report.rows.iter().map(|row| {
        let [problem, method, motion, scalar] = &row.names;
        let (instructions, flops) = row.cost.counted();
        let (mcu_instructions, mcu_cycles) = row.cost.emulated();
        Line {
            problem,
            method,
            motion,
            scalar,
            accuracy: &row.accuracy,
            time_ratio: row.cost.time,
            instructions,
            flops,
            mcu_instructions,
            mcu_cycles,
        }
    });
    let Report { seed, asked, answered, ref doubt, .. } = *report;
    Table { seed, actuators: asked, answered, reference: doubt, rows: rows.collect() }
}
