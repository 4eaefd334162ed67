//! `softlimb-lab validation`: the published set, recorded.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use clap::Args;
use softlimb::cli::fea::{Calculix, as_json, text};
use softlimb::cli::{Failure, Outcome, write};
use softlimb::comparison::{Comparison, picture};

use super::{PLACE, cases, page};
use crate::published::Published;

/// Compare the analytic model with finite elements on the published set: four motions, two sizes, two materials
#[derive(Args)]
#[command(
    after_help = "The file of --tsv keeps the cases that are left out, and CalculiX's answers to the same pressures. All of it:\n  \
                  cargo xtask lab validation --calculix --tsv tests/golden/validation.tsv --svg docs/evidence/validation.svg --page docs/evidence/validation.md"
)]
pub(crate) struct Validation {
    /// Only cases whose name contains this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    #[command(flatten)]
    solid: Calculix,
    #[command(flatten)]
    published: Published,
}

impl Validation {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let section = self.published.page(PLACE)?;
        let cases: Vec<_> = cases().into_iter().filter(|case| case.name.contains(&self.only)).collect();
        if cases.is_empty() {
            return Err(Failure::new(format!("no case has \"{}\" in its name", self.only)));
        }
        let recorded = self.published.tsv.as_deref().map(recorded).transpose()?.unwrap_or_default();
        // The file holds the cases done so far: a run of hours may end early.
        let mut study = self.solid.compare(&cases, |study| {
            let joined = || study.comparison.clone().onto(&recorded);
            self.published.tsv.as_deref().map_or(Ok(()), |file| write(file, &joined().tsv()))
        })?;
        study.comparison = study.comparison.onto(&recorded);
        self.published.show(|| as_json(&study.comparison), || text(&study))?;
        // Picture and page show the figures of the file, to the digit.
        let comparison = Comparison::from_tsv(&study.comparison.tsv()).map_err(Failure::new)?;
        self.published.draw(|| picture(&comparison))?;
        section.map_or(Ok(()), |section| section.write(&page(&comparison)))?;
        Ok(if study.warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}

/// The comparison that a file holds already; none if there is no such file.
fn recorded(file: &Path) -> Result<Comparison, Failure> {
    match fs::read_to_string(file) {
        Ok(text) => Comparison::from_tsv(&text).map_err(|error| Failure::file("use", file, &error)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Comparison::default()),
        Err(error) => Err(Failure::file("read", file, &error)),
    }
}
