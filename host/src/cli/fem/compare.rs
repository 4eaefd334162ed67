//! `softlimb fem compare`: the analytic model beside finite elements.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::super::kept::{Kept, write};
use super::super::{Failure, Outcome, note};
use super::values::seconds;
use crate::comparison::{Case, Comparison, Progress, Study, StudyError, picture, study};
use softlimb_fea::solid::Runner;
use softlimb_limb::{Limb, LimbModule};

/// Pressure against deformation: analytic model, finite elements of the section, and CalculiX side by side
#[derive(Args)]
#[command(after_help = "Example: softlimb fem compare scenes/pick-and-place-a.toml --svg compare.svg")]
pub(super) struct Compare {
    /// The scene whose actuators are compared, up to each one's highest pressure
    scene: PathBuf,
    /// Only modules whose name contains this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    #[command(flatten)]
    solid: Calculix,
    #[command(flatten)]
    kept: Kept,
}

/// Options of CalculiX.
#[derive(Args)]
pub struct Calculix {
    /// Run CalculiX too: seconds to minutes for each actuator
    #[arg(long)]
    calculix: bool,
    /// The CalculiX program
    #[arg(long, value_name = "PROGRAM", default_value = "ccx", requires = "calculix")]
    ccx: PathBuf,
    /// End each CalculiX run after so many seconds, 0.1 to 1000000; what had converged by then stands
    #[arg(long, value_name = "SECONDS", default_value_t = Runner::default().timeout_s, allow_negative_numbers = true,
        value_parser = seconds, requires = "calculix")]
    timeout_s: f64,
}

/// Steps of the pressure for a scene's actuators.
const STEPS: usize = 6;

impl Compare {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let cases: Vec<Case> = self.cases()?.into_iter().filter(|case| case.name.contains(&self.only)).collect();
        if cases.is_empty() {
            return Err(Failure::new(format!("no module has \"{}\" in its name", self.only)));
        }
        let keep =
            |comparison: &Comparison| self.kept.tsv.as_deref().map_or(Ok(()), |file| write(file, &comparison.tsv()));
        let study = self.solid.compare(&cases, |_| Ok(()))?;
        keep(&study.comparison)?;
        self.kept.show(|| as_json(&study.comparison), || text(&study))?;
        self.kept.draw(|| picture(&study.comparison))?;
        Ok(if study.warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn cases(&self) -> Result<Vec<Case>, Failure> {
        let limb = Limb::new(&softlimb_scene::load(&self.scene)?)?;
        let case = |module: &LimbModule| Case {
            name: module.name.clone(),
            parameters: *module.actuator.parameters(),
            pressures_pa: (1..=STEPS).map(|k| module.pressure_max_pa * k as f64 / STEPS as f64).collect(),
        };
        Ok(limb.modules().iter().map(case).collect())
    }
}

impl Calculix {
    /// Compares every case behind a progress bar and prints the warnings; `done` receives the study after each case.
    ///
    /// # Errors
    /// [`Failure`] of a case, of CalculiX, or of `done`.
    pub fn compare(
        &self,
        cases: &[Case],
        mut done: impl FnMut(&Study) -> Result<(), Failure>,
    ) -> Result<Study, Failure> {
        let bar = ProgressBar::new(1000 * cases.len() as u64);
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let runner =
            self.calculix.then(|| Runner { ccx: self.ccx.clone(), timeout_s: self.timeout_s, ..Runner::default() });
        let begin = Instant::now();
        let study = study(cases, runner.as_ref(), &|| begin.elapsed().as_secs_f64(), &mut |progress| match progress {
            Progress::Cases(cases) => {
                bar.set_position((1000.0 * cases) as u64);
                Ok(())
            }
            Progress::Done(study) => done(study),
        });
        bar.finish_and_clear();
        let study = study?;
        study.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
        Ok(study)
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        Self::new(error)
    }
}

/// Tables and times of a study.
pub fn text(study: &Study) -> String {
    format!("{}\n{}", study.comparison.table().trim_end(), study.times())
}

/// Rows of a comparison as JSON.
pub fn as_json(comparison: &Comparison) -> serde_json::Value {
    let rows = comparison.rows.iter().map(|row| {
        serde_json::json!({
            "case": row.case, "quantity": row.quantity.label(), "rest": row.rest, "pressure_kpa": row.pressure_kpa,
            "analytic": row.analytic, "calibrated": row.calibrated, "section": row.section, "section_error": row.section_error, "calculix": row.solid,
            "analytic_difference": row.difference(row.analytic), "calculix_difference": row.difference(row.solid),
        })
    });
    serde_json::json!({ "rows": rows.collect::<Vec<_>>() })
}
