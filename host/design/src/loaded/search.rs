//! The search: bounded least squares on what the margins lack, from several starts, then with a rising reserve.

use super::evaluate::{Evaluation, Judgement, evaluate};
use super::local_solve::{At, NOTHING, abreast, local};
use super::plates::shifts_m;
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::least_squares::Minimum;
use softlimb_numerics::{Kronecker, Random};

/// Standard deviation of a hop from the best limb, in the unit box.
const HOP: f64 = 0.02;
/// Reserve that a limb is sought with, and by how much it is raised at a time.
const RESERVE: f64 = 0.03;
const RAISE: f64 = 0.05;
/// Part of the reserve that a limb keeps at least, so that tubes between plates keep every margin, too.
const KEPT: f64 = 0.4;
/// Steps of a local solve with another reserve or another bound.
pub(super) const RAISE_STEPS: usize = 10;
/// Steps of a local solve that tells a good start from a bad one.
const SHORT_STEPS: usize = 8;
/// Turns of a local solve and of the shifts of its tubes, and the change of a shift that is none, m.
const SHIFT_TURNS: usize = 4;
const SHIFTED_M: f64 = 5e-5;
/// A sum of squares below which the shifts of a limb's tubes are worth knowing.
const NEAR: f64 = 0.1;

/// Bounds of a search.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seed of the starts.
    pub seed: u64,
    /// Limbs that are looked at before any is improved.
    pub samples: usize,
    /// The best of them, which are improved by a few steps each before the best of those is improved further.
    pub short: usize,
    /// Rounds of two local solves: from beside the best limb, and from the next start.
    pub rounds: usize,
    /// Threads; the answer does not depend on them.
    pub abreast: usize,
    /// Steps of a local solve.
    pub steps: usize,
    /// Rises of the reserve.
    pub raises: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 0, samples: 64, short: 8, rounds: 12, abreast: 2, steps: 40, raises: 3 }
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
    /// The reserve that it was sought with, which all margins have where it is reached, and the shifts of its tubes.
    pub by: Judgement,
    /// Limbs judged.
    pub evaluations: usize,
}

/// A limb that a local solve has led to.
pub(super) struct Candidate {
    minimum: Minimum<At>,
    pub(super) by: Judgement,
    /// Whether every margin is kept with a part of the reserve.
    keeps: bool,
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
/// `start` is a first guess in the unit box. `stop` is asked between local solves. `None` where no limb of the samples stands at all.
pub fn search(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Found> {
    let mut starts = sample(task, space, start, effort);
    let mut evaluations = starts.len();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<Candidate> = None;
    let mut by = Judgement { reserve: RESERVE, shifts_m: Vec::new() };
    // A few steps tell good starts from bad ones; the best of them go on first.
    let short: Vec<Vec<f64>> = starts.drain(..starts.len().min(effort.short)).map(|(_, point)| point).collect();
    let mut begun = Vec::with_capacity(short.len());
    for points in short.chunks(effort.abreast.max(1)) {
        let solves = abreast(points, |point| solved(task, space, point, &by, (SHORT_STEPS, 1)));
        for (candidate, count) in solves.into_iter().flatten() {
            evaluations += count;
            begun.push(candidate);
        }
        if stop() {
            break;
        }
    }
    begun.sort_by(|a, b| a.minimum.objective.total_cmp(&b.minimum.objective));
    let rest = starts.into_iter().map(|(_, point)| point);
    let mut queue = begun.into_iter().map(|candidate| candidate.minimum.point).chain(rest);
    let mut random = Random::new(effort.seed, 2);
    for _ in 0..effort.rounds {
        // One solve goes on from beside the best limb: a kink of the residuals is left, or a better valley found.
        let beside = best.as_ref().map(|best| {
            let step = |x: &f64| (x + HOP * random.normal()).clamp(0.0, 1.0);
            best.minimum.point.iter().map(step).collect::<Vec<f64>>()
        });
        for point in beside.into_iter().chain(queue.next()) {
            let Some((candidate, count)) = solved(task, space, &point, &by, (effort.steps, effort.abreast)) else {
                continue;
            };
            evaluations += count;
            if best.as_ref().is_none_or(|best| candidate.merit() < best.merit()) {
                best = Some(candidate);
            }
            if best.as_ref().is_some_and(|best| best.keeps) {
                break;
            }
        }
        if let Some(found) = best.take_if(|best| best.keeps) {
            let (settled, count) = with_shifts(task, space, found, effort.abreast);
            evaluations += count;
            by.shifts_m = settled.by.shifts_m.clone();
            best = Some(settled);
        } else if let Some(best) = best.as_ref().filter(|best| best.minimum.objective <= NEAR) {
            by.shifts_m = shifts_m(task, space, best.limb(), RESERVE);
        }
        if best.as_ref().is_some_and(|best| best.keeps) || stop() {
            break;
        }
    }
    let mut best = best?;
    if best.keeps {
        let (higher, count) = raised(task, space, &best.minimum.point, &best.by, (effort.raises, effort.abreast), stop);
        evaluations += count;
        let settled = higher.map(|higher| with_shifts(task, space, higher, effort.abreast));
        if let Some((settled, count)) = settled {
            evaluations += count;
            if settled.keeps {
                best = settled;
            }
        }
    }
    let Candidate { minimum, by, keeps } = best;
    Some(Found { point: minimum.point, reached: keeps, by, evaluation: minimum.evaluation.limb, evaluations })
}

/// The limb that a local solve leads to, and the limbs judged.
fn solved(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    by: &Judgement,
    (steps, abreast): (usize, usize),
) -> Option<(Candidate, usize)> {
    let (mut minimum, count) = local(task, space, start, by, (steps, abreast))?;
    let (mut by, mut keeps) = (by.clone(), minimum.objective <= NOTHING);
    if !keeps {
        let less = Judgement { reserve: by.reserve.min(KEPT * RESERVE), ..by.clone() };
        let limb = &minimum.evaluation.limb;
        if let Some(limb) =
            evaluate(task, space, &limb.sizes, &less, Some(limb)).filter(|limb| limb.objective() <= NOTHING)
        {
            (minimum.objective, minimum.evaluation.limb) = (limb.objective(), limb);
            (by, keeps) = (less, true);
        }
    }
    Some((Candidate { minimum, by, keeps }, count))
}

/// Solves for the limb and updates its tube shifts alternately until both agree. Returns the limb and the number of limbs evaluated.
fn with_shifts(task: &LoadedTask, space: &LimbSpace, mut found: Candidate, abreast: usize) -> (Candidate, usize) {
    let mut evaluations = 0;
    for _ in 0..SHIFT_TURNS {
        let shifts_m = shifts_m(task, space, found.limb(), found.by.reserve);
        let change_m = (0..shifts_m.len()).flat_map(|pose| {
            let before = found.by.shifts_m.get(pose).copied().unwrap_or_default();
            [0, 1].map(|state: usize| (shifts_m[pose][state] - before[state]).norm())
        });
        let change_m = change_m.fold(0.0, f64::max);
        if change_m <= SHIFTED_M {
            return (found, evaluations);
        }
        let by = Judgement { shifts_m, ..found.by.clone() };
        let Some((next, count)) = solved(task, space, &found.minimum.point, &by, (RAISE_STEPS, abreast)) else { break };
        evaluations += count;
        found = next;
        if !found.keeps {
            return (found, evaluations);
        }
    }
    found.keeps = false;
    (found, evaluations)
}

/// The limb with the largest reserve that rises of it lead to from a limb that keeps that of `by`, and the limbs judged.
pub(super) fn raised(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    by: &Judgement,
    (raises, abreast): (usize, usize),
    stop: &(dyn Fn() -> bool + Sync),
) -> (Option<Candidate>, usize) {
    let Some((mut best, mut evaluations)) = solved(task, space, start, by, (RAISE_STEPS, abreast)) else {
        return (None, 0);
    };
    let mut raise = RAISE;
    for _ in 0..raises {
        if stop() {
            break;
        }
        let next = Judgement { reserve: best.by.reserve + raise, ..best.by.clone() };
        let Some((higher, count)) = solved(task, space, &best.minimum.point, &next, (RAISE_STEPS, abreast)) else {
            break;
        };
        evaluations += count;
        if higher.keeps && higher.by.reserve > best.by.reserve {
            (best, raise) = (higher, 1.6 * raise);
        } else {
            raise *= 0.4;
        }
    }
    (Some(best), evaluations)
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
    let by = Judgement { reserve: RESERVE, ..Judgement::default() };
    let judged = abreast(&shares, |points| {
        let judge = |point: &Vec<f64>| {
            let limb = evaluate(task, space, &space.sizes(point), &by, None)?;
            Some((limb.objective(), point.clone()))
        };
        points.iter().filter_map(judge).collect::<Vec<_>>()
    });
    judged.into_iter().flatten().collect()
}
