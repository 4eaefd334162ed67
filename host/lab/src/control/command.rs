//! `softlimb-lab control`: the control table.

use clap::Args;
use softlimb::cli::{Failure, Outcome};

use super::{Group, HEADING, Line, PLACE, lines, page, picture, run};
use crate::published::Published;

/// Follow steps, a sine and a trajectory with chambers of three sizes, on the nominal plant and on 60 others
#[derive(Args)]
#[command(after_help = "All of it:\n  \
                        cargo xtask lab control --tsv tests/golden/control.tsv --svg docs/evidence/control.svg --page docs/evidence/control.md")]
pub(crate) struct Control {
    #[command(flatten)]
    published: Published,
}

impl Control {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let section = self.published.page(PLACE)?;
        let trials = run(&Group::ALL);
        let lines = lines(&trials);
        let tsv = HEADING.to_owned() + &lines.iter().map(Line::tsv).collect::<String>();
        self.published.keep(|| tsv.clone())?;
        self.published.draw(|| picture::picture(&trials))?;
        self.published.show(|| &lines, || tsv.clone() + &page(&lines))?;
        section.map_or(Ok(()), |section| section.write(&page(&lines)))?;
        for fault in trials.iter().filter_map(|trial| trial.recording.fault.as_ref()) {
            softlimb::cli::say(&format!("{fault}\n"))?;
        }
        let is_whole = trials.iter().all(|trial| trial.recording.fault.is_none());
        Ok(if is_whole { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}
