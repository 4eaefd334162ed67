//! `softlimb-lab choice`.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Instant;

use clap::Args;
use indicatif::ProgressBar;

use softlimb::cli::fea::Calculix;
use softlimb::cli::{Failure, Outcome, read};
use softlimb::comparison::Comparison;

use super::{BENDERS, Choice, Model, PLACE, SEED, Seconds, measure, page, picture};
use crate::published::Published;
use crate::validation::cases;

/// Published comparison with CalculiX, from the folder of this package.
const VALIDATION: &str = "../../tests/golden/validation.tsv";
/// The bender that CalculiX is timed on.
const TIMED: &str = "bending, 6/8 mm, neo-Hookean";

/// Error of the bend against the time of one answer: analytic, cubic, table, section FE, CalculiX
#[derive(Args)]
#[command(
    after_help = "Errors of CalculiX are those of tests/golden/validation.tsv. Its time is that of one bender with --calculix, and else that of the file of --tsv.\n\
                  The published record: cargo xtask lab choice --calculix --tsv tests/golden/choice.tsv --svg docs/evidence/choice.svg \
                  --page docs/evidence/accuracy.md"
)]
pub(crate) struct Command {
    /// Number of benders
    #[arg(long, value_name = "N", default_value_t = BENDERS as u32, value_parser = clap::value_parser!(u32).range(1..=1000))]
    benders: u32,
    /// Seed of the set of benders
    #[arg(long, default_value_t = SEED)]
    seed: u64,
    #[command(flatten)]
    solid: Calculix,
    #[command(flatten)]
    published: Published,
}

impl Command {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let section = self.published.page(PLACE)?;
        let recorded = self.published.tsv.as_deref().map(recorded).transpose()?.unwrap_or_default();
        let validation = Path::new(env!("CARGO_MANIFEST_DIR")).join(VALIDATION);
        let compared = Comparison::from_tsv(&read(&validation)?);
        let compared = compared.map_err(|error| Failure::file("use", &validation, &error))?;
        let bar = ProgressBar::new(self.benders.into());
        let begin = Instant::now();
        let clock = || begin.elapsed().as_secs_f64();
        let measured = measure(self.seed, self.benders as usize, Some(&clock), |done| bar.set_position(done as u64));
        bar.finish_and_clear();
        let mut choice = measured.map_err(Failure::new)?;
        let timed: Vec<_> = cases().into_iter().filter(|case| case.name == TIMED).collect();
        let study = self.solid.compare(&timed, |_| Ok(()))?;
        let by_calculix = study.seconds.iter().zip(&timed).find_map(|((_, _, solid_s), case)| {
            let answer = solid_s.map(|seconds| seconds / case.pressures_pa.len() as f64)?;
            Some(Seconds { preparation: None, answer: Some(answer) })
        });
        let solid = Model::Calculix as usize;
        choice.seconds[solid] = by_calculix.unwrap_or(recorded.seconds[solid]);
        // Picture and page show the figures of the file, to the digit.
        let choice = Choice::from_tsv(&choice.tsv()).map_err(Failure::new)?;
        self.published.show(|| &choice, || page(&choice, &compared))?;
        self.published.keep(|| choice.tsv())?;
        self.published.draw(|| picture(&choice, &compared))?;
        section.map_or(Ok(()), |section| section.write(&page(&choice, &compared)))?;
        Ok(if study.warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}

/// The record that a file holds already; an empty one if there is no such file.
fn recorded(file: &Path) -> Result<Choice, Failure> {
    match fs::read_to_string(file) {
        Ok(text) => Choice::from_tsv(&text).map_err(|error| Failure::file("use", file, &error)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Choice::default()),
        Err(error) => Err(Failure::file("read", file, &error)),
    }
}
