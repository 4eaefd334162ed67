//! `softlimb-lab truth`: the ablation table of the true body.

use std::path::{Path, PathBuf};

use clap::Args;
use softlimb::cli::{Failure, Outcome, read, say, write};

use super::picture::picture;
use super::table::{PLACE, heading, line, rows};
use super::{LIMBS, row};
use crate::generated_section::replaced;

/// Compare tip errors on the planner's own limb and on a true body, each effect of it alone and all together
#[derive(Args)]
#[command(
    after_help = "All of it:\n  cargo xtask lab truth --svg docs/evidence/truth.svg --page docs/evidence/truth.md"
)]
pub(crate) struct Truth {
    /// Scenes of the folder `scenes`, by name
    #[arg(long, value_name = "NAME", num_args = 1.., default_values = ["pick-and-place-a", "pick-and-place-b", "pick-and-place-c"])]
    scene: Vec<String>,
    /// Iterations of learning
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=200))]
    iterations: u32,
    /// Write the picture
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Replace the table in the page of the documentation that has a place for it
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

impl Truth {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let mut text = heading(self.iterations);
        say(&text)?;
        for name in &self.scene {
            for limb in LIMBS {
                let found = line(&row(&folder, name, limb, self.iterations)?);
                say(&found)?;
                text = format!("{text}\n{found}");
            }
        }
        text.push_str("\n\n");
        if let Some(file) = &self.svg {
            // The picture shows what the table says, to the digit.
            write(file, &picture(&rows(&text)))?;
        }
        if let Some(file) = &self.page {
            let document = replaced(&read(file)?, PLACE, &text);
            let document =
                document.ok_or_else(|| Failure::new(format!("{} has no place for the table", file.display())))?;
            write(file, &document)?;
        }
        Ok(Outcome::Done)
    }
}
