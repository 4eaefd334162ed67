//! The search: bounded least squares on what the margins lack, from several starts, then with a rising reserve.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::candidate::{Candidate, attempt, solved};
use super::confirm::{ConfirmedPose, confirm};
use super::evaluate::{Evaluation, Judgement, evaluate};
use super::local_solve::abreast;
use super::race::Race;
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::Random;

/// By how much the reserve is raised at a time.
pub(super) const RAISE: f64 = 0.05;
/// Steps of a local solve with another reserve or another bound.
pub(super) const RAISE_STEPS: usize = 15;
/// Standard deviations of the starts about the first guess, in the unit box, one after the other.
const SPREADS: [f64; 3] = [0.1, 0.15, 0.25];

/// Limbs that the planner may refuse before the search ends.
const REFUSALS: usize = 6;

/// Why a planner refuses a limb, or which margin it does not keep as the planner has it; `None` where it keeps all.
pub type Refusal<'a> = dyn Fn(&Evaluation) -> Option<String> + Sync + 'a;

/// Bounds of a search.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seed of the starts; that of 0 begins with the first guess itself.
    pub seed: u64,
    /// Most starts.
    pub starts: usize,
    /// Threads; the answer does not depend on them.
    pub abreast: usize,
    /// Steps of a local solve.
    pub steps: usize,
    /// Rises of the reserve.
    pub raises: usize,
    /// Whether tubes between plates keep every margin, too; else the answer is that of rods, without their reserve.
    pub by_tubes: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 0, starts: 256, abreast: 2, steps: 40, raises: 3, by_tubes: true }
    }
}

/// Result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    /// The limb.
    pub evaluation: Evaluation,
    /// Its point of the unit box, then the shares of its pressures.
    pub point: Vec<f64>,
    /// Whether every margin is kept, by tubes between plates, too.
    pub reached: bool,
    /// The reserve that it was sought with, which all margins have where it is reached, and the shifts of its tubes.
    pub by: Judgement,
    /// The limb by tubes between plates.
    pub confirmed: Vec<ConfirmedPose>,
    /// Why the planner refuses it; `None` where it keeps all.
    pub refused: Option<String>,
    /// Limbs of earlier starts that the planner has refused.
    pub refused_before: usize,
    /// Limbs judged.
    pub evaluations: usize,
}

/// Searches for a limb that keeps every margin with a reserve, without a planner: as [`search_to_run`].
pub fn search(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Found> {
    search_to_run(task, space, start, effort, &|_| None, stop)
}

/// Searches for a limb that keeps every margin with a reserve, and that a planner does not refuse.
///
/// `start` is a first guess in the unit box. `refusal` judges each limb that tubes between plates confirm: the search goes on to the next start where it
/// refuses one, and ends with the sixth, whose answer is the first one. `stop` is asked between local solves. `None` where no limb of the starts stands
/// at all.
pub fn search_to_run(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    refusal: &Refusal<'_>,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Found> {
    let starts = starts(start, effort);
    let race = Race::new(REFUSALS);
    let evaluations = AtomicUsize::new(0);
    let threads: Vec<usize> = (0..effort.abreast.max(1)).collect();
    abreast(&threads, |_| {
        while let Some(index) = race.next(starts.len()).filter(|_| !stop()) {
            let given_up = || race.is_over_for(index) || stop();
            let mut counted = 0;
            let candidate = attempt(task, space, &starts[index], effort, refusal, &given_up, &mut counted);
            evaluations.fetch_add(counted, Ordering::Relaxed);
            candidate.into_iter().for_each(|candidate| race.enter(index, candidate));
        }
    });
    let (best, refused_before) = race.winner()?;
    let Candidate { minimum, mut by, keeps: mut reached, refused } = best;
    let (point, mut limb) = (minimum.point, minimum.evaluation.limb);
    if space.modules.iter().any(|module| module.laws.is_some()) {
        // `check` has the law of the radii found, without interpolation.
        limb = limb.reaching(task, &space.at_radii(&limb.sizes), &by).unwrap_or(limb);
    }
    let confirmed = if effort.by_tubes { confirm(task, &limb, &by) } else { Vec::new() };
    let keeps_all = || confirmed.iter().all(|pose| pose.lacks.is_empty());
    if effort.by_tubes && reached {
        reached = keeps_all();
    } else if effort.by_tubes {
        // A limb that lacks a part of the reserve alone keeps every margin, too.
        reached = keeps_all();
        by.reserve = 0.0;
    }
    let evaluations = evaluations.into_inner();
    Some(Found { point, reached, by, evaluation: limb, confirmed, refused, refused_before, evaluations })
}

/// The limb at a point of the unit box by tubes between plates; empty where it does not stand.
pub fn confirmed(task: &LoadedTask, space: &LimbSpace, point: &[f64]) -> Vec<ConfirmedPose> {
    let by = Judgement { moves: true, ..Judgement::default() };
    evaluate(task, space, &space.sizes(point), &by).map_or_else(Vec::new, |limb| confirm(task, &limb, &by))
}

/// Points of the unit box about the first guess; with seed 0 the first is the guess itself.
fn starts(guess: &[f64], effort: &Effort) -> Vec<Vec<f64>> {
    let mut random = Random::new(effort.seed, 1);
    let point = |index: usize| {
        let spread = if index == 0 && effort.seed == 0 { 0.0 } else { SPREADS[index % SPREADS.len()] };
        guess.iter().map(|x| (x + spread * random.normal()).clamp(0.0, 1.0)).collect()
    };
    (0..effort.starts.max(1)).map(point).collect()
}

/// The reserve that a local solve with that of `by` keeps from a limb at a point; 0 where it keeps none.
pub(super) fn reserve_from(task: &LoadedTask, space: &LimbSpace, at: (&[f64], &Evaluation), by: &Judgement) -> f64 {
    let higher = solved(task, space, at, by, RAISE_STEPS, &mut 0);
    higher.filter(|higher| higher.keeps).map_or(0.0, |higher| higher.by.reserve)
}
