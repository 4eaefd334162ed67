//! The search: bounded least squares on what the margins lack, from several starts, then with a rising reserve.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::candidate::{Candidate, attempt, solved, with_shifts};
use super::confirm::{ConfirmedPose, confirm};
use super::evaluate::{Evaluation, Judgement, evaluate};
use super::local_solve::abreast;
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::Random;

/// By how much the reserve is raised at a time.
pub(super) const RAISE: f64 = 0.05;
/// Steps of a local solve with another reserve or another bound.
pub(super) const RAISE_STEPS: usize = 10;
/// Standard deviations of the starts about the first guess, in the unit box, one after the other.
const SPREADS: [f64; 3] = [0.1, 0.15, 0.25];

/// Bounds of a search.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seed of the starts.
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
    /// Limbs judged.
    pub evaluations: usize,
}

/// Searches for a limb that keeps every margin, and then for one that keeps them with a reserve.
///
/// `start` is a first guess in the unit box. `stop` is asked between local solves. `None` where no limb of the starts stands at all.
pub fn search(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Found> {
    let (best, mut evaluations) = raced(task, space, start, effort, stop);
    let mut best = best?;
    if best.keeps && effort.by_tubes {
        let (higher, count) = raised(task, space, &best, effort.raises, stop);
        evaluations += count;
        best = higher.unwrap_or(best);
    }
    let Candidate { minimum, mut by, keeps: mut reached, mut confirmed } = best;
    let limb = minimum.evaluation.limb;
    if confirmed.is_empty() && effort.by_tubes {
        confirmed = confirm(task, &limb, &by);
        // A limb that lacks a part of the reserve alone keeps every margin, too.
        reached = confirmed.iter().all(|pose| pose.lacks.is_empty());
        by.reserve = 0.0;
    }
    Some(Found { point: minimum.point, reached, by, evaluation: limb, confirmed, evaluations })
}

/// The limb at a point of the unit box by tubes between plates; empty where it does not stand.
pub fn confirmed(task: &LoadedTask, space: &LimbSpace, point: &[f64]) -> Vec<ConfirmedPose> {
    let by = Judgement { moves: true, ..Judgement::default() };
    evaluate(task, space, &space.sizes(point), &by).map_or_else(Vec::new, |limb| confirm(task, &limb, &by))
}

/// The limb of the first start that leads to one that keeps every margin, or else the best one, and the limbs judged. Threads take one start after the
/// other; those behind a start that has led to a limb are given up, so that the answer does not depend on them.
fn raced(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    stop: &(dyn Fn() -> bool + Sync),
) -> (Option<Candidate>, usize) {
    let starts = starts(start, effort);
    let (next, first, evaluations) = (AtomicUsize::new(0), AtomicUsize::new(usize::MAX), AtomicUsize::new(0));
    let best: Mutex<Option<(usize, Candidate)>> = Mutex::new(None);
    let threads: Vec<usize> = (0..effort.abreast.max(1)).collect();
    abreast(&threads, |_| {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= starts.len() || index > first.load(Ordering::Relaxed) || stop() {
                return;
            }
            let given_up = || first.load(Ordering::Relaxed) < index || stop();
            let mut counted = 0;
            let candidate = attempt(task, space, &starts[index], effort, &given_up, &mut counted);
            evaluations.fetch_add(counted, Ordering::Relaxed);
            let Some(candidate) = candidate else { continue };
            if candidate.keeps {
                first.fetch_min(index, Ordering::Relaxed);
            }
            let mut best = best.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let order = |(index, candidate): &(usize, Candidate)| {
                let (lacks, objective) = candidate.merit();
                (lacks, if lacks { objective } else { 0.0 }, *index)
            };
            let own = (index, candidate);
            if best.as_ref().is_none_or(|best| order(&own) < order(best)) {
                *best = Some(own);
            }
        }
    });
    let best = best.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    (best.map(|(_, candidate)| candidate), evaluations.into_inner())
}

/// Points of the unit box: the first guess, then some about it.
fn starts(guess: &[f64], effort: &Effort) -> Vec<Vec<f64>> {
    let mut random = Random::new(effort.seed, 1);
    let point = |index: usize| {
        let spread = if index == 0 { 0.0 } else { SPREADS[index % SPREADS.len()] };
        guess.iter().map(|x| (x + spread * random.normal()).clamp(0.0, 1.0)).collect()
    };
    (0..effort.starts.max(1)).map(point).collect()
}

/// The reserve that a local solve with that of `by` keeps from a limb at a point; 0 where it keeps none.
pub(super) fn reserve_from(task: &LoadedTask, space: &LimbSpace, at: (&[f64], &Evaluation), by: &Judgement) -> f64 {
    let higher = solved(task, space, at, by, RAISE_STEPS, &mut 0);
    higher.filter(|higher| higher.keeps).map_or(0.0, |higher| higher.by.reserve)
}

/// The limb with the largest reserve that rises of it lead to from a limb that keeps that of its own, and the limbs judged. `None` where none is
/// higher.
fn raised(
    task: &LoadedTask,
    space: &LimbSpace,
    from: &Candidate,
    raises: usize,
    stop: &(dyn Fn() -> bool + Sync),
) -> (Option<Candidate>, usize) {
    let (mut best, mut evaluations): (Option<Candidate>, usize) = (None, 0);
    let mut raise = RAISE;
    for _ in 0..raises {
        if stop() {
            break;
        }
        let here = best.as_ref().unwrap_or(from);
        let by = Judgement { reserve: here.by.reserve + raise, ..here.by.clone() };
        let at = (&here.minimum.point[..], here.limb());
        let higher = solved(task, space, at, &by, RAISE_STEPS, &mut evaluations);
        let higher = higher.filter(|higher| higher.keeps && higher.by.reserve > here.by.reserve);
        let higher = higher.map(|higher| with_shifts(task, space, higher, &mut evaluations));
        let higher = higher.filter(|higher| higher.keeps).map(|mut higher| {
            higher.confirm(task);
            higher
        });
        match higher.filter(|higher| higher.keeps) {
            Some(higher) => (best, raise) = (Some(higher), 1.6 * raise),
            None => raise *= 0.4,
        }
    }
    (best, evaluations)
}
