//! `softlimb fem compare`: the analytic model beside finite elements.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::super::kept::Kept;
use super::super::{Failure, Outcome, note};
use super::values::seconds;
use crate::design::Limb;
use crate::fem::{self, End, FemError, Runner, Subject};
use crate::scene;
use crate::validation::{self, Case, Comparison, Quantity, Solid};

/// Pressure against deformation: analytic model, finite elements of the section, and CalculiX side by side
#[derive(Args)]
#[command(
    after_help = "Without a scene the published set is compared: four motions, two sizes, two materials. The file of --tsv then keeps the \
                  cases that are left out, and what CalculiX said of the same pressures before. All of it:\n  \
                  softlimb fem compare --calculix --tsv tests/golden/validation.tsv --svg docs/evidence/validation.svg --page docs/evidence/validation.md"
)]
pub(super) struct Compare {
    /// The scene whose actuators are compared, up to each one's highest pressure
    scene: Option<PathBuf>,
    /// Only cases whose name contains this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
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
    #[command(flatten)]
    kept: Kept,
}

/// Steps of the pressure for a scene's actuators.
const STEPS: usize = 6;

/// What was compared, and the seconds it took.
#[derive(Default)]
struct Done {
    comparison: Comparison,
    /// Of each case: the section's curve, and CalculiX.
    seconds: Vec<(String, f64, Option<f64>)>,
    warnings: Vec<String>,
}

impl Compare {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let page = self.kept.page(validation::PLACE)?;
        let cases: Vec<Case> = self.cases()?.into_iter().filter(|case| case.name.contains(&self.only)).collect();
        if cases.is_empty() {
            return Err(Failure::new(format!("no case has \"{}\" in its name", self.only)));
        }
        let recorded = self.kept.tsv.as_deref().map(recorded).transpose()?.unwrap_or_default();
        let done = self.compare(&cases, &recorded)?;
        done.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
        let Done { comparison, seconds, .. } = &done;
        self.kept.show(|| as_json(comparison), || format!("{}\n{}", comparison.table().trim_end(), times(seconds)))?;
        // Picture and page show what the file says, to the digit.
        let comparison = &Comparison::from_tsv(&comparison.tsv()).map_err(Failure::new)?;
        self.kept.draw(|| validation::picture(comparison))?;
        if let Some(file) = &self.kept.tsv {
            note(&format!("wrote {}", file.display()));
        }
        page.map_or(Ok(()), |page| page.write(validation::refreshed(&page.text, comparison)))?;
        Ok(if done.warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn cases(&self) -> Result<Vec<Case>, Failure> {
        let Some(scene) = &self.scene else { return Ok(validation::cases()) };
        let limb = Limb::new(&scene::load(scene)?)?;
        let case = |module: &crate::design::LimbModule| Case {
            name: module.name.clone(),
            parameters: *module.actuator.parameters(),
            pressures_pa: (1..=STEPS).map(|k| module.pressure_max_pa * k as f64 / STEPS as f64).collect(),
        };
        Ok(limb.modules().iter().map(case).collect())
    }

    /// Compares every case. What is done is in the file after each.
    fn compare(&self, cases: &[Case], recorded: &Comparison) -> Result<Done, Failure> {
        let bar = ProgressBar::new(1000 * cases.len() as u64);
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let mut done = Done::default();
        let mut new = Comparison::default();
        for (index, case) in cases.iter().enumerate() {
            bar.set_message(case.name.clone());
            let named = |error| Failure::new(format!("{}: {error}", case.name));
            let begin = Instant::now();
            let curve = validation::section_curve(case).map_err(named)?;
            let seconds = begin.elapsed().as_secs_f64();
            let share = |share: f64| bar.set_position((1000.0 * (index as f64 + share)) as u64);
            let (solid, solid_seconds) = match self.calculix {
                true => self.solid(case, &share, &mut done.warnings)?,
                false => (Solid::new(), None),
            };
            done.seconds.push((case.name.clone(), seconds, solid_seconds));
            new.rows.extend(validation::compare(case, &curve, &solid).map_err(named)?);
            done.comparison = if self.scene.is_none() { new.clone().onto(recorded) } else { new.clone() };
            if let Some(file) = &self.kept.tsv {
                fem::write_whole(file, &done.comparison.tsv()).map_err(|error| Failure::new(&error))?;
            }
        }
        bar.finish_and_clear();
        Ok(done)
    }

    /// What CalculiX says of a case, and its seconds. A run that fails or ends early is a warning, and its converged part stands.
    fn solid(
        &self,
        case: &Case,
        share: &dyn Fn(f64),
        warnings: &mut Vec<String>,
    ) -> Result<(Solid, Option<f64>), Failure> {
        let runner = Runner { ccx: self.ccx.clone(), timeout_s: self.timeout_s, ..Runner::default() };
        let begin = Instant::now();
        let clock = || begin.elapsed().as_secs_f64();
        let (subject, options) = (Subject::single(case.parameters), fem::Options::default());
        let mut progress = |progress: fem::RunProgress| share(progress.share);
        let run = match fem::run(&subject, &options, &case.pressures_pa, &runner, &clock, &mut progress) {
            Ok(run) => run,
            Err(error @ (FemError::Missing { .. } | FemError::Invalid(_))) => return Err(Failure::new(error)),
            Err(error) => {
                warnings.push(format!("{}: {error}", case.name));
                return Ok((Solid::new(), None));
            }
        };
        match &run.end {
            End::Finished => {}
            End::Diverged { diagnosis, .. } => warnings.push(format!("{}: {diagnosis}", case.name)),
            End::TimedOut => warnings.push(format!("{}: CalculiX took more than {} s", case.name, self.timeout_s)),
        }
        let quantity = Quantity::of(case.parameters.motion);
        let value = |point: &fem::Point| point.middle.map(|rates| quantity.of_rates(&rates, case.parameters.length_m));
        Ok((run.points.iter().map(value).collect(), Some(run.seconds)))
    }
}

/// The section's times beside those of CalculiX, and their ranges.
fn times(seconds: &[(String, f64, Option<f64>)]) -> String {
    let mut text = String::from("section, ms   CalculiX, s    ratio\n");
    for (name, section, solid) in seconds {
        let (solid, ratio) = match solid {
            Some(solid) => (format!("{solid:.1}"), format!("{:.0}", solid / section)),
            None => ("-".to_owned(), "-".to_owned()),
        };
        text += &format!("{:>11.0} {solid:>13} {ratio:>8}   {name}\n", section * 1e3);
    }
    let [least, most] = range(seconds.iter().map(|(_, section, _)| section * 1e3));
    text += &format!("a curve takes the section {least:.0} to {most:.0} ms");
    let ratios = || seconds.iter().filter_map(|(_, section, solid)| Some((*solid)? / section));
    if ratios().count() > 0 {
        let [least, most] = range(ratios());
        text += &format!(", and CalculiX {least:.0} to {most:.0} times as long");
    }
    text + "\n"
}

/// The least and the most of some numbers.
fn range(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], n| [least.min(n), most.max(n)])
}

fn as_json(comparison: &Comparison) -> serde_json::Value {
    let rows = comparison.rows.iter().map(|row| {
        json!({
            "case": row.case, "quantity": row.quantity.label(), "rest": row.rest, "pressure_kpa": row.pressure_kpa,
            "analytic": row.analytic, "calibrated": row.calibrated, "section": row.section, "section_error": row.section_error, "calculix": row.solid,
            "analytic_difference": row.difference(row.analytic), "calculix_difference": row.difference(row.solid),
        })
    });
    json!({ "rows": rows.collect::<Vec<_>>() })
}

/// The comparison that a file holds already; none if there is no such file.
fn recorded(file: &Path) -> Result<Comparison, Failure> {
    match fs::read_to_string(file) {
        Ok(text) => Comparison::from_tsv(&text).map_err(|error| Failure::file("use", file, &error)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Comparison::default()),
        Err(error) => Err(Failure::file("read", file, &error)),
    }
}
