//! The search: bounded least squares on what the margins lack, from several starts, then with a rising reserve.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::confirm::{ConfirmedPose, confirm};
use super::evaluate::{Evaluation, Judgement, evaluate};
use super::local_solve::{At, NOTHING, abreast, local, with_pressures};
use super::plates::shifts;
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::Minimum;

/// Reserve that a limb is sought with, and by how much it is raised at a time.
const RESERVE: f64 = 0.03;
pub(super) const RAISE: f64 = 0.05;
/// Part of the reserve that a limb keeps at least, so that tubes between plates keep every margin, too.
const KEPT: f64 = 0.4;
/// Steps of a local solve with another reserve or another bound.
pub(super) const RAISE_STEPS: usize = 10;
/// Steps of a local solve that tells a good start from a bad one, and the sum of squares up to which it is a good one.
const SHORT_STEPS: usize = 10;
const GOOD: f64 = 5.0;
/// A sum of squares up to which a limb may keep every margin with less of the reserve, once its tip is moved to the places.
const NEAR: f64 = 0.05;
/// Turns of a local solve and of the shifts of its tubes.
const SHIFT_TURNS: usize = 4;
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

/// A limb that a local solve has led to.
pub(super) struct Candidate {
    pub(super) minimum: Minimum<At>,
    pub(super) by: Judgement,
    /// Whether every margin is kept with a part of the reserve.
    pub(super) keeps: bool,
    confirmed: Vec<ConfirmedPose>,
}

impl Candidate {
    fn merit(&self) -> (bool, f64) {
        (!self.keeps, self.minimum.objective)
    }

    fn limb(&self) -> &Evaluation {
        &self.minimum.evaluation.limb
    }
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
    let Candidate { minimum, by, keeps, mut confirmed } = best;
    let limb = minimum.evaluation.limb;
    if confirmed.is_empty() && effort.by_tubes {
        confirmed = confirm(task, &limb, &by);
    }
    Some(Found { point: minimum.point, reached: keeps, by, evaluation: limb, confirmed, evaluations })
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

/// The limb that a start leads to, cheap to dear: a few steps, the poses, the moves, tubes between plates, and the confirmation by them.
fn attempt(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    given_up: &dyn Fn() -> bool,
    evaluations: &mut usize,
) -> Option<Candidate> {
    let steps = effort.steps;
    let mut by = Judgement { reserve: RESERVE, ..Judgement::default() };
    let limb = evaluate(task, space, &space.sizes(start), &by)?;
    *evaluations += 1;
    let mut here = solved(task, space, (start, &limb), &by, SHORT_STEPS, evaluations)?;
    if !here.keeps && here.minimum.objective <= GOOD && !given_up() {
        here = solved(task, space, (&here.minimum.point, here.limb()), &by, steps, evaluations)?;
    }
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    by.moves = true;
    here = solved(task, space, (&here.minimum.point, here.limb()), &by, steps, evaluations)?;
    if !effort.by_tubes {
        return Some(here);
    }
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    here = with_shifts(task, space, here, evaluations);
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    here.confirm(task);
    Some(here)
}

impl Candidate {
    /// The same with some of its margins not judged.
    fn unproven(mut self) -> Self {
        self.keeps = false;
        self
    }

    /// Judges it by tubes between plates.
    fn confirm(&mut self, task: &LoadedTask) {
        self.confirmed = confirm(task, self.limb(), &self.by);
        self.keeps = self.confirmed.iter().all(|pose| pose.lacks.is_empty());
    }
}

/// The limb that a local solve leads to.
fn solved(
    task: &LoadedTask,
    space: &LimbSpace,
    (start, near): (&[f64], &Evaluation),
    by: &Judgement,
    steps: usize,
    evaluations: &mut usize,
) -> Option<Candidate> {
    let (mut minimum, count) = local(task, space, start, near, by, steps)?;
    *evaluations += count;
    let (mut by, mut keeps) = (by.clone(), minimum.objective <= NOTHING);
    if !keeps && minimum.objective <= NEAR {
        let less = Judgement { reserve: by.reserve.min(KEPT * RESERVE), ..by.clone() };
        let limb = minimum.evaluation.limb.reaching(task, space, &less);
        if let Some(limb) = limb.filter(|limb| limb.objective() <= NOTHING) {
            minimum.point = with_pressures(task, &minimum.point[..space.variables().len()], &limb);
            (minimum.objective, minimum.evaluation.limb) = (limb.objective(), limb);
            (by, keeps) = (less, true);
        }
    }
    Some(Candidate { minimum, by, keeps, confirmed: Vec::new() })
}

/// Solves for the limb and updates its tube shifts alternately until both agree.
fn with_shifts(task: &LoadedTask, space: &LimbSpace, mut found: Candidate, evaluations: &mut usize) -> Candidate {
    for _ in 0..SHIFT_TURNS {
        let shifts = shifts(task, found.limb());
        let change = shifts.iter().enumerate().map(|(pose, shift)| shift.change(&found.by.shift(pose)));
        if change.fold(0.0, f64::max) <= 1.0 {
            return found;
        }
        let by = Judgement { shifts, ..found.by.clone() };
        let at = (&found.minimum.point[..], found.limb());
        let Some(next) = solved(task, space, at, &by, RAISE_STEPS, evaluations) else { break };
        found = next;
        if !found.keeps {
            return found;
        }
    }
    found.keeps = false;
    found
}

/// The reserve that a local solve with that of `by` keeps from a limb at a point; 0 where it keeps none.
pub(super) fn reserve_from(
    task: &LoadedTask,
    space: &LimbSpace,
    at: (&[f64], &Evaluation),
    by: &Judgement,
) -> f64 {
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
