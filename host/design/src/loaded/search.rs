//! The search: bounded least squares on what the margins lack, from several starts, then with a rising reserve.

use std::panic::resume_unwind;

use super::evaluate::{Evaluation, evaluate, evaluate_beside};
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::least_squares::{LeastSquares, Minimum, StoppingCriteria, minimise};
use softlimb_numerics::{Kronecker, Random};

/// Step of a derivative in the unit box.
const STEP: f64 = 2e-3;
/// A sum of squares that counts as nothing lacking: 0.03 mm, or 0.1 % of a limit, which the reserve covers.
pub(super) const NOTHING: f64 = 1e-5;
/// Standard deviation of a hop from the best limb, in the unit box.
const HOP: f64 = 0.02;
/// Reserve that a limb is sought with, and by how much it is raised at a time.
const RESERVE: f64 = 0.03;
const RAISE: f64 = 0.05;
/// Steps of a local solve with another reserve or another bound.
pub(super) const RAISE_STEPS: usize = 10;

/// Bounds of a search.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seed of the starts.
    pub seed: u64,
    /// Limbs that are looked at before any is improved.
    pub samples: usize,
    /// Rounds of local solves; as many solves a round as `abreast`.
    pub rounds: usize,
    /// Local solves of a round, each in a thread of its own; the answer depends on it.
    pub abreast: usize,
    /// Steps of a local solve.
    pub steps: usize,
    /// Rises of the reserve.
    pub raises: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 0, samples: 64, rounds: 12, abreast: 2, steps: 40, raises: 3 }
    }
}

/// Result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    /// The limb.
    pub evaluation: Evaluation,
    /// Its point of the unit box.
    pub point: Vec<f64>,
    /// Whether every margin is kept.
    pub reached: bool,
    /// The largest reserve that all margins were found with.
    pub reserve: f64,
    /// Limbs judged.
    pub evaluations: usize,
}

struct Problem<'a> {
    task: &'a LoadedTask,
    space: &'a LimbSpace,
    reserve: f64,
    evaluations: usize,
    warm: Option<Evaluation>,
    /// Threads of a Jacobian.
    abreast: usize,
}

impl Problem<'_> {
    fn at(&mut self, point: &[f64]) -> Option<Evaluation> {
        self.evaluations += 1;
        evaluate(self.task, self.space, &self.space.sizes(point), self.reserve, self.warm.as_ref())
    }
}

impl Problem<'_> {
    /// Derivative of the residuals by one variable; zeros where the limb beside does not stand.
    fn column(&self, at: &At, here: &[f64], axis: usize) -> Vec<f64> {
        let step = if at.point[axis] > 0.5 { -STEP } else { STEP };
        let mut point = at.point.clone();
        point[axis] += step;
        match evaluate_beside(self.task, self.space, &self.space.sizes(&point), self.reserve, &at.limb) {
            Some(there) => there.lacks.iter().zip(here).map(|(there, here)| (there.value - here) / step).collect(),
            None => vec![0.0; here.len()],
        }
    }
}

/// A point with its limb.
pub(super) struct At {
    point: Vec<f64>,
    pub(super) limb: Evaluation,
}

impl LeastSquares for Problem<'_> {
    type Evaluation = At;

    fn evaluate(&mut self, point: &[f64]) -> Option<At> {
        Some(At { point: point.to_vec(), limb: self.at(point)? })
    }

    fn residuals(&self, at: &At) -> Vec<f64> {
        at.limb.lacks.iter().map(|lack| lack.value).collect()
    }

    fn jacobian(&mut self, at: &At) -> Option<Vec<Vec<f64>>> {
        self.warm = Some(at.limb.clone());
        let here: Vec<f64> = self.residuals(at);
        self.evaluations += at.point.len();
        let axes: Vec<usize> = (0..at.point.len()).collect();
        let parts: Vec<&[usize]> = axes.chunks(axes.len().div_ceil(self.abreast.max(1)).max(1)).collect();
        let columns = abreast(&parts, |axes| axes.iter().map(|axis| self.column(at, &here, *axis)).collect::<Vec<_>>());
        let columns: Vec<Vec<f64>> = columns.into_iter().flatten().collect();
        Some((0..here.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
    }
}

/// Searches for a limb that keeps every margin, and then for one that keeps them with a reserve.
///
/// `start` is a first guess in the unit box. `stop` is asked between local solves. `None` where no limb of the samples stands at all.
pub fn search(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Found> {
    let mut evaluations = 0;
    let mut starts = sample(task, space, start, effort);
    evaluations += starts.len();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut queue = starts.into_iter().map(|(_, point)| point);
    let mut best: Option<(Minimum<At>, bool)> = None;
    let mut random = Random::new(effort.seed, 2);
    for _ in 0..effort.rounds {
        // One solve goes on from beside the best limb: a kink of the residuals is left, or a better valley found.
        let beside = best.as_ref().map(|(best, _)| {
            let step = |x: &f64| (x + HOP * random.normal()).clamp(0.0, 1.0);
            best.point.iter().map(step).collect::<Vec<f64>>()
        });
        let fresh = queue.by_ref().take(effort.abreast.saturating_sub(usize::from(beside.is_some())).max(1));
        let points: Vec<Vec<f64>> = beside.into_iter().chain(fresh).collect();
        let solves = abreast(&points, |point| {
            let (minimum, count) = local(task, space, point, RESERVE, (effort.steps, 1))?;
            let keeps = keeps(task, space, &minimum);
            Some((minimum, keeps, count))
        });
        for (minimum, keeps, count) in solves.into_iter().flatten() {
            evaluations += count;
            let merit = |minimum: &Minimum<At>, keeps: bool| (!keeps, minimum.objective);
            if best.as_ref().is_none_or(|(best, kept)| merit(&minimum, keeps) < merit(best, *kept)) {
                best = Some((minimum, keeps));
            }
        }
        if best.as_ref().is_some_and(|(_, keeps)| *keeps) || stop() {
            break;
        }
    }
    let (best, reached) = best?;
    let mut reserve = if reached && best.objective <= NOTHING { RESERVE } else { 0.0 };
    let (mut point, mut limb) = (best.point, best.evaluation.limb);
    if reserve > 0.0
        && let Some((minimum, higher, count)) =
            raised(task, space, &point, reserve, (effort.raises, effort.abreast), stop)
    {
        evaluations += count;
        (point, limb, reserve) = (minimum.point, minimum.evaluation.limb, higher);
    }
    Some(Found { point, reached, reserve, evaluation: limb, evaluations })
}

/// Whether every margin is kept without a reserve.
fn keeps(task: &LoadedTask, space: &LimbSpace, minimum: &Minimum<At>) -> bool {
    let limb = &minimum.evaluation.limb;
    minimum.objective <= NOTHING
        || evaluate(task, space, &limb.sizes, 0.0, Some(limb)).is_some_and(|limb| limb.objective() <= NOTHING)
}

/// The limb with the largest reserve that rises of it lead to from a limb that keeps `reserve`, that reserve, and the limbs judged.
pub(super) fn raised(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    reserve: f64,
    (raises, abreast): (usize, usize),
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<(Minimum<At>, f64, usize)> {
    let (mut best, mut evaluations) = local(task, space, start, reserve, (RAISE_STEPS, abreast))?;
    let (mut reserve, mut raise) = (reserve, RAISE);
    for _ in 0..raises {
        if stop() {
            break;
        }
        let next = reserve + raise;
        let Some((minimum, count)) = local(task, space, &best.point, next, (RAISE_STEPS, abreast)) else { break };
        evaluations += count;
        if minimum.objective <= NOTHING {
            (best, reserve, raise) = (minimum, next, 1.6 * raise);
        } else {
            raise *= 0.4;
        }
    }
    Some((best, reserve, evaluations))
}

/// Limbs of the box with the sum of squares of what they lack; those that do not stand are left out.
fn sample(task: &LoadedTask, space: &LimbSpace, start: &[f64], effort: &Effort) -> Vec<(f64, Vec<f64>)> {
    let axes = start.len();
    let spread = Kronecker::new(axes.max(1), effort.seed);
    let mut random = Random::new(effort.seed, 1);
    let near = |random: &mut Random| start.iter().map(|x| (x + 0.2 * random.normal()).clamp(0.0, 1.0)).collect();
    let point = |index: usize| match index {
        0 => start.to_vec(),
        odd if odd % 2 == 1 => near(&mut random),
        even => (0..axes).map(|axis| spread.coordinate(even, axis)).collect::<Vec<f64>>(),
    };
    let points: Vec<Vec<f64>> = (0..effort.samples.max(1)).map(point).collect();
    let shares: Vec<Vec<Vec<f64>>> =
        points.chunks(points.len().div_ceil(effort.abreast.max(1))).map(<[_]>::to_vec).collect();
    let judged = abreast(&shares, |points| {
        let judge = |point: &Vec<f64>| {
            let limb = evaluate(task, space, &space.sizes(point), RESERVE, None)?;
            Some((limb.objective(), point.clone()))
        };
        points.iter().filter_map(judge).collect::<Vec<_>>()
    });
    judged.into_iter().flatten().collect()
}

/// The limb that least squares lead to, and the limbs judged.
pub(super) fn local(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    reserve: f64,
    (steps, abreast): (usize, usize),
) -> Option<(Minimum<At>, usize)> {
    let mut problem = Problem { task, space, reserve, evaluations: 0, warm: None, abreast };
    let criteria = StoppingCriteria {
        zero: NOTHING,
        relative: 1e-4,
        least_gain: 5e-3,
        evaluations: steps.max(1),
        ..StoppingCriteria::default()
    };
    let minimum = minimise(&mut problem, start, criteria)?;
    Some((minimum, problem.evaluations))
}

/// Applies `work` to every item, each in a thread of its own, in their order.
fn abreast<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    std::thread::scope(|scope| {
        let handles: Vec<_> = items.iter().map(|item| scope.spawn(|| work(item))).collect();
        handles.into_iter().map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}
