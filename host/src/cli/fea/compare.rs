//! `softlimb fea compare`: the analytic model beside finite elements.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::super::shared::{Kept, bar, limb, quantity, show, write_if};
use super::super::{Failure, Outcome, note};
use crate::comparison::{Case, Comparison, Progress, Study, StudyError, label, picture, study};
use softlimb_fea::solid::Runner;
use softlimb_limb::LimbModule;
use softlimb_scene::Quantity;

/// Pressure against deformation: analytic model, finite elements of the section, and CalculiX side by side
#[derive(Args)]
#[command(after_help = "Example: softlimb fea compare scenes/pick-and-place-a.toml --svg compare.svg")]
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
    /// Time after which CalculiX is ended, 0.1 to 1e6 s; results converged by then are kept
    #[arg(long, value_name = "SECONDS", default_value = "1800 s", value_parser = quantity("s", 0.1, 1e6), requires = "calculix")]
    timeout: Quantity,
}

/// Steps of the pressure for a scene's actuators.
const STEPS: usize = 6;

impl Compare {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let cases: Vec<Case> = self.cases()?.into_iter().filter(|case| case.name.contains(&self.only)).collect();
        if cases.is_empty() {
            return Err(Failure::new(format!("no module has \"{}\" in its name", self.only)));
        }
        let study = self.solid.compare(&cases, |_| Ok(()))?;
        write_if(self.kept.tsv.as_ref(), || study.comparison.tsv())?;
        show(self.kept.json, &as_json(&study.comparison), || text(&study))?;
        write_if(self.kept.svg.as_ref(), || picture(&study.comparison))?;
        Ok(if study.warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn cases(&self) -> Result<Vec<Case>, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        scene.require_no_segments("`fea`")?;
        let case = |module: &LimbModule| Case {
            name: module.name.clone(),
            parameters: *module.actuator.parameters(),
            second_fiber: module.second_fiber().copied(),
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
        let bar = bar(1000 * cases.len() as u64, "comparing");
        let runner =
            self.calculix.then(|| Runner { ccx: self.ccx.clone(), timeout_s: self.timeout.si(), ..Runner::default() });
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

/// A comparison as JSON.
#[derive(Serialize)]
struct Rows {
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    case: String,
    quantity: String,
    rest: f64,
    pressure_kpa: f64,
    analytic: Option<f64>,
    calibrated: Option<f64>,
    section: Option<f64>,
    section_error: Option<f64>,
    calculix: Option<f64>,
    analytic_difference: Option<f64>,
    calculix_difference: Option<f64>,
}

/// Rows of a comparison as JSON.
pub fn as_json(comparison: &Comparison) -> impl Serialize + use<> {
    let rows = comparison.rows.iter().map(|row| Row {
        case: row.case.clone(),
        quantity: label(row.motion),
        rest: row.rest,
        pressure_kpa: row.pressure_kpa,
        analytic: row.analytic,
        calibrated: row.calibrated,
        section: row.section,
        section_error: row.section_error,
        calculix: row.solid,
        analytic_difference: row.difference(row.analytic),
        calculix_difference: row.difference(row.solid),
    });
    Rows { rows: rows.collect() }
}
