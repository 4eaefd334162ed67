//! The search for one order of modules: local solves from many starts, and basin hops from the best of their minima.
//!
//! A start is a random geometry whose tip is first brought to the way-points without obstacles. A basin hop takes a good minimum, gives the way-point
//! that is worst off new deformations, or the limb new sizes, and solves again: limbs that touch an obstacle on the wrong side do not
//! come round it by descending.

use super::layout::Layout;
use super::local_solve::{criteria, solve};
use super::objective::Objective;
use softlimb_numerics::Random;

/// Minima that are kept to hop from.
const KEPT: usize = 6;
/// Random deformations that a way-point is given in one hop.
const TRIES: usize = 6;
/// Evaluations of a local solve without obstacles, one of a single way-point, and one of all.
const FIRST: usize = 25;
const SINGLE: usize = 12;
const ALL: usize = 60;

/// Result of a local solve.
#[derive(Clone, Debug)]
pub(super) struct LocalMinimum {
    pub(super) place: Vec<f64>,
    /// Objective, mm2, by the interpolated response.
    pub(super) value: f64,
}

/// Result of a search and its cost.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    /// The best minima, the best first.
    pub(super) minima: Vec<LocalMinimum>,
    /// Evaluations of all way-points with derivatives.
    pub(super) evaluations: usize,
    /// Local solves with obstacles.
    pub(super) local_solves: usize,
}

/// Searches until the objective is at most `zero` (mm2) or the evaluations are spent.
pub(super) fn search(objective: &mut Objective, random: &mut Random, zero: f64, evaluations: usize) -> Found {
    let mut found = Found::default();
    while found.evaluations < evaluations {
        // Random starts first; then hops, and every fourth time another start.
        let fresh = found.minima.len() < 3 || found.local_solves.is_multiple_of(4);
        let place = if fresh { start(objective, random, &mut found) } else { hop(objective, random, &mut found) };
        let Some(mut place) = place else { continue };
        let all: Vec<usize> = (0..place.len()).collect();
        objective.layout.wrap(&mut place);
        let (mut value, spent) = solve(objective, &mut place, &all, criteria(zero, 1e-3, ALL));
        found.evaluations += spent;
        found.local_solves += 1;
        if found.minima.first().is_none_or(|best| value < 4.0 * best.value) && value > zero {
            let (better, spent) = solve(objective, &mut place, &all, criteria(zero, 1e-6, 2 * ALL));
            found.evaluations += spent;
            value = better;
        }
        keep(&mut found.minima, LocalMinimum { place, value });
        if found.minima[0].value <= zero {
            break;
        }
    }
    found
}

/// Keeps the best minima that differ.
fn keep(minima: &mut Vec<LocalMinimum>, minimum: LocalMinimum) {
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-3 * (a + b);
    if minima.iter().any(|kept| same(kept.value, minimum.value)) {
        return;
    }
    let at = minima.partition_point(|kept| kept.value <= minimum.value);
    minima.insert(at, minimum);
    minima.truncate(KEPT);
}

/// A random place with the mount angles in the middle of their range.
fn anywhere(layout: &Layout, random: &mut Random) -> Vec<f64> {
    let mut place = random.point(layout.width());
    layout.wrap(&mut place);
    place
}

/// A random geometry with its tip brought to the way-points; `None` where that is not worth going on with.
fn start(objective: &mut Objective, random: &mut Random, found: &mut Found) -> Option<Vec<f64>> {
    let mut place = anywhere(&objective.layout, random);
    let all: Vec<usize> = (0..place.len()).collect();
    objective.obstacles = false;
    let (value, spent) = solve(objective, &mut place, &all, criteria(1e-2, 0.05, FIRST));
    objective.obstacles = true;
    // A pose alone costs less than one with obstacles.
    found.evaluations += spent.div_ceil(2);
    let worth = found.minima.get(2).is_none_or(|kept| value < 10.0 * kept.value + 10.0);
    worth.then_some(place)
}

/// A place near a good minimum.
fn hop(objective: &mut Objective, random: &mut Random, found: &mut Found) -> Option<Vec<f64>> {
    let pick = (found.minima.len() as f64 * random.uniform().powi(2)) as usize;
    let mut place = found.minima.get(pick)?.place.clone();
    let moved = random.uniform();
    if moved < 0.7 {
        let size = 0.5 * random.uniform().powi(2);
        for x in place.iter_mut().take(objective.layout.shared) {
            *x = (*x + size * (2.0 * random.uniform() - 1.0)).clamp(0.0, 1.0);
        }
    }
    if moved > 0.3 {
        let worst = worst_way_point(objective, &place, random);
        again(objective, &mut place, worst, random, found);
    }
    Some(place)
}

/// A way-point, the more likely the more it adds to the objective.
fn worst_way_point(objective: &mut Objective, place: &[f64], random: &mut Random) -> usize {
    let count = objective.task.way_points.len();
    let values: Vec<f64> = (0..count)
        .map(|index| {
            objective.only = Some(index);
            objective.at(place).value.sqrt()
        })
        .collect();
    objective.only = None;
    let mut drawn = random.uniform() * values.iter().sum::<f64>();
    values
        .iter()
        .position(|value| {
            drawn -= value;
            drawn <= 0.0
        })
        .unwrap_or(count - 1)
}

/// Gives one way-point the best of several new deformations.
fn again(objective: &mut Objective, place: &mut Vec<f64>, way_point: usize, random: &mut Random, found: &mut Found) {
    let shares: Vec<usize> =
        (0..objective.tables.len()).map(|module| objective.layout.share(way_point, module)).collect();
    objective.only = Some(way_point);
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut spent = 0;
    for _ in 0..TRIES {
        let mut trial = place.clone();
        shares.iter().for_each(|index| trial[*index] = random.uniform());
        let (value, cost) = solve(objective, &mut trial, &shares, criteria(1e-3, 0.02, SINGLE));
        spent += cost;
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            best = Some((value, trial));
        }
    }
    objective.only = None;
    found.evaluations += spent.div_ceil(objective.task.way_points.len());
    if let Some((_, trial)) = best {
        *place = trial;
    }
}
