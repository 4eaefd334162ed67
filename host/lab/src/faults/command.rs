//! `softlimb-lab faults`: the matrix in virtual time.

use clap::Args;
use softlimb::cli::{Failure, Outcome};

use super::{HEADING, PLACE, cases, lines, page, run};
use crate::published::Published;

/// Break every part in every phase of a run, on three sizes of chambers, and judge the device by the true pressures
#[derive(Args)]
#[command(after_help = "All of it:\n  \
                        cargo xtask lab faults --tsv tests/golden/faults.tsv --page docs/evidence/faults.md")]
pub(crate) struct Faults {
    /// Only faults whose name contains this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    #[command(flatten)]
    published: Published,
}

impl Faults {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let section = self.published.page(PLACE)?;
        let cases: Vec<_> = cases().into_iter().filter(|case| case.row.name.contains(&self.only)).collect();
        if cases.is_empty() {
            return Err(Failure::new(format!("no fault has \"{}\" in its name", self.only)));
        }
        let lines = lines(&run(&cases));
        let tsv = HEADING.to_owned() + &lines.iter().map(super::Line::tsv).collect::<String>();
        self.published.keep(|| tsv.clone())?;
        self.published.show(|| &lines, || tsv.clone() + &page(&lines))?;
        section.map_or(Ok(()), |section| section.write(&page(&lines)))?;
        let is_whole = lines.iter().all(|line| line.cases[0] == line.cases[1]);
        Ok(if is_whole { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}
