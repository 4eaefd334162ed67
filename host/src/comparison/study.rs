//! Every model on a list of cases, with the seconds each took.

use softlimb_fea::cross_section::SectionError;
use softlimb_fea::solid::{self, End, FemError, Point, Runner, Subject};

use super::case::{Case, of_rates};
use super::compare::{Comparison, Solid, compare, section_curve};

/// Comparison of some cases.
#[derive(Clone, Debug, Default)]
pub struct Study {
    /// Results of all models.
    pub comparison: Comparison,
    /// Of each case: its name, seconds of the section's curve, and of CalculiX where it ran.
    pub seconds: Vec<(String, f64, Option<f64>)>,
    /// CalculiX runs that failed or ended early; their converged part stands.
    pub warnings: Vec<String>,
}

/// Failure of a study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A case that is no actuator.
    #[error("{case}: {error}")]
    Case {
        /// Name of the case.
        case: String,
        /// Cause.
        error: SectionError,
    },
    /// CalculiX is missing, or its options are out of range.
    #[error(transparent)]
    Solid(#[from] FemError),
}

/// Progress of a study.
#[derive(Clone, Copy, Debug)]
pub enum Progress<'a> {
    /// Cases done, with the fraction of the one at work.
    Cases(f64),
    /// A case is done; the study so far.
    Done(&'a Study),
}

/// Compares every case, with CalculiX too where there is a `runner`. `clock` gives seconds of any origin.
///
/// # Errors
/// [`StudyError`]; an error of `progress` ends the study.
pub fn study<E: From<StudyError>>(
    cases: &[Case],
    runner: Option<&Runner>,
    clock: &dyn Fn() -> f64,
    progress: &mut dyn FnMut(Progress<'_>) -> Result<(), E>,
) -> Result<Study, E> {
    let mut study = Study::default();
    for (index, case) in cases.iter().enumerate() {
        progress(Progress::Cases(index as f64))?;
        let named = |error| StudyError::Case { case: case.name.clone(), error };
        let begin = clock();
        let curve = section_curve(case).map_err(named)?;
        let section_s = clock() - begin;
        let mut solid = (Solid::new(), None);
        if let Some(runner) = runner {
            // An interrupted display must not end a run of CalculiX: its error is raised at the next case.
            let mut share = |share: f64| drop(progress(Progress::Cases(index as f64 + share)));
            solid = by_calculix(case, runner, clock, &mut share, &mut study.warnings)?;
        }
        let (solid, solid_s) = solid;
        study.seconds.push((case.name.clone(), section_s, solid_s));
        study.comparison.rows.extend(compare(case, &curve, &solid).map_err(named)?);
        progress(Progress::Done(&study))?;
    }
    Ok(study)
}

/// CalculiX's answers to a case, and its seconds. A run that fails or ends early is a warning, and its converged part stands.
fn by_calculix(
    case: &Case,
    runner: &Runner,
    clock: &dyn Fn() -> f64,
    share: &mut dyn FnMut(f64),
    warnings: &mut Vec<String>,
) -> Result<(Solid, Option<f64>), StudyError> {
    let (subject, options) =
        (Subject::single(case.parameters).with_second_fiber(case.second_fiber), solid::Options::default());
    let mut progress = |progress: solid::RunProgress| share(progress.share);
    let run = match solid::run(&subject, &options, &case.pressures_pa, runner, clock, &mut progress) {
        Ok(run) => run,
        Err(error @ (FemError::Missing { .. } | FemError::Invalid(_))) => return Err(error.into()),
        Err(error) => {
            warnings.push(format!("{}: {error}", case.name));
            return Ok((Solid::new(), None));
        }
    };
    match &run.end {
        End::Finished => {}
        End::Diverged { diagnosis, .. } => warnings.push(format!("{}: {diagnosis}", case.name)),
        End::TimedOut => warnings.push(format!("{}: CalculiX took more than {} s", case.name, runner.timeout_s)),
    }
    let value =
        |point: &Point| point.middle.map(|rates| of_rates(case.parameters.motion, &rates, case.parameters.length_m));
    Ok((run.points.iter().map(value).collect(), Some(run.seconds)))
}

impl Study {
    /// The section's times beside those of CalculiX, and their ranges.
    pub fn times(&self) -> String {
        let mut text = String::from("section, ms   CalculiX, s    ratio\n");
        for (name, section, solid) in &self.seconds {
            let (solid, ratio) = match solid {
                Some(solid) => (format!("{solid:.1}"), format!("{:.0}", solid / section)),
                None => ("-".to_owned(), "-".to_owned()),
            };
            text += &format!("{:>11.0} {solid:>13} {ratio:>8}   {name}\n", section * 1e3);
        }
        let [least, most] = range(self.seconds.iter().map(|(_, section, _)| section * 1e3));
        text += &format!("a curve takes the section {least:.0} to {most:.0} ms");
        let ratios = || self.seconds.iter().filter_map(|(_, section, solid)| Some((*solid)? / section));
        if ratios().count() > 0 {
            let [least, most] = range(ratios());
            text += &format!(", and CalculiX {least:.0} to {most:.0} times as long");
        }
        text + "\n"
    }
}

/// The least and the most of some numbers.
fn range(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], n| [least.min(n), most.max(n)])
}
