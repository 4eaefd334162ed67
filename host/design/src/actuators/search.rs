//! Where to begin, and when enough descents agree.

use serde::Serialize;

use super::actuator::Counts;
use super::problem::{Problem, Segment};
use super::reach::{Separate, Span};
use super::ridge::settle;
use super::shared::Shared;
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::{Descent, LeastSquares, Stop, minimise, sum_of_squares};

/// Geometries that are looked at before any descent.
const TRIALS: usize = 24;
/// The first of them: the middle of the bounds, then towards wide and thin sections, which deform most; the rest are random. Lengths adapt.
const LOOKED_AT: [[f64; 4]; 5] =
    [[0.5, 0.5, 0.5, 0.5], [0.8, 0.2, 0.7, 0.5], [1.0, 0.0, 1.0, 0.5], [1.0, 0.0, 1.0, 0.0], [1.0, 0.0, 1.0, 1.0]];
/// As many descents at least must agree on one supply line: the best basin may be one that few starts lie in.
const ON_A_LINE: usize = 8;
/// Objectives within this share of each other agree.
const SAME: f64 = 1e-6;

/// How long to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Seed of the starts.
    pub seed: u64,
    /// Most descents, of each segment or of the limb on one supply line; at least 1.
    pub starts: usize,
    /// As many descents must end at the best objective before the search stops early; on one supply line at least eight.
    pub agreeing: usize,
    /// No descent begins after as many evaluations.
    pub evaluations: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 1, starts: 40, agreeing: 5, evaluations: 2500 }
    }
}

/// How the descents of a search ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Starts {
    /// Descents made; a geometry that reaches every goal at once counts as one.
    pub made: usize,
    /// Those that ended at the best objective.
    pub agreeing: usize,
}

/// How far a search has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The least objective so far.
    pub objective: f64,
    /// What it has cost so far.
    pub counts: Counts,
}

/// A least-squares problem that counts what it costs.
pub(super) trait Counted: LeastSquares {
    fn counts(&self) -> Counts;
}

/// A problem, and somebody who is told when an evaluation is better than all before.
pub(super) struct Watched<'w, L> {
    pub(super) problem: L,
    least: f64,
    watch: &'w mut dyn FnMut(&Progress),
}

impl<'w, L: Counted> Watched<'w, L> {
    fn new(problem: L, watch: &'w mut dyn FnMut(&Progress)) -> Self {
        Self { problem, least: f64::INFINITY, watch }
    }

    /// Of an objective that has been found.
    pub(super) fn tell(&mut self, objective: f64) {
        if objective < self.least {
            self.least = objective;
            (self.watch)(&Progress { objective, counts: self.problem.counts() });
        }
    }
}

impl<L: Counted> LeastSquares for Watched<'_, L> {
    type Point = L::Point;

    fn at(&mut self, place: &[f64]) -> Option<L::Point> {
        let point = self.problem.at(place)?;
        self.tell(sum_of_squares(&self.problem.residuals(&point)));
        Some(point)
    }

    fn residuals(&self, point: &L::Point) -> Vec<f64> {
        self.problem.residuals(point)
    }

    fn rows(&mut self, point: &L::Point) -> Option<Vec<Vec<f64>>> {
        self.problem.rows(point)
    }
}

/// The best of a search.
pub(super) struct Found {
    /// Place of the geometry in its unit box, and of the shares behind it where there are.
    pub(super) place: Vec<f64>,
    pub(super) pressures_pa: Vec<f64>,
    pub(super) objective: f64,
    pub(super) starts: Starts,
    pub(super) counts: Counts,
}

/// The size of the goals: `sum w q^2`.
fn scale<'a>(segments: impl IntoIterator<Item = &'a Segment>) -> f64 {
    let goals = segments.into_iter().flat_map(|segment| segment.goals.iter().flatten());
    goals.map(|goal| goal.weight * goal.value * goal.value).sum()
}

fn stop(scale: f64) -> Stop {
    Stop { zero: 1e-24 * scale, relative: 1e-16, steps: 200 }
}

/// Descends from one start after another until enough agree. `start` makes the next one, `settle` goes on from where one ended.
fn descend<L: Counted>(
    problem: &mut Watched<L>,
    effort: &Effort,
    stop: Stop,
    mut start: impl FnMut(&mut L, usize) -> Option<Vec<f64>>,
    settle: impl Fn(&mut Watched<L>, Descent<L::Point>) -> Descent<L::Point>,
) -> Option<(Descent<L::Point>, Starts)> {
    let mut best: Option<Descent<L::Point>> = None;
    let mut ends: Vec<f64> = Vec::new();
    let mut starts = Starts::default();
    for index in 0..effort.starts {
        if index > 0 && problem.problem.counts().evaluations >= effort.evaluations {
            break;
        }
        let place = start(&mut problem.problem, index);
        let Some(end) = place.and_then(|place| minimise(problem, &place, stop)) else { continue };
        let end = settle(problem, end);
        ends.push(end.objective);
        if best.as_ref().is_none_or(|best| end.objective < best.objective) {
            best = Some(end);
        }
        let least = best.as_ref().map_or(f64::INFINITY, |best| best.objective);
        let agreeing = ends.iter().filter(|end| **end <= least * (1.0 + SAME) + stop.zero).count();
        starts = Starts { made: ends.len(), agreeing };
        if least <= stop.zero || agreeing >= effort.agreeing {
            break;
        }
    }
    Some((best?, starts))
}

/// What a look at some geometries of a segment gives.
enum Look {
    /// One has every goal.
    Exact { place: Vec<f64>, pressures_pa: Vec<f64> },
    /// None has; the places by what is left there, the least first.
    Ranked(Vec<Vec<f64>>),
}

/// Looks at some geometries, at a length within reach where there is one.
fn look(problem: &mut Watched<Separate>, random: &mut Random) -> Look {
    let segment = problem.problem.segment;
    let width = segment.dimensions();
    let mut ranked = Vec::new();
    for trial in 0..TRIALS {
        let mut place = LOOKED_AT.get(trial).map_or_else(|| random.place(width), |place| place[..width].to_vec());
        let counts = &mut problem.problem.counts;
        let Some(mut span) = Span::new(segment, &place, counts) else { continue };
        if let Some(length_m) = span.better_length().filter(|_| span.estimate() > 0.0) {
            let [low, width] = segment.axis(2);
            place[2] = if width > 0.0 { (length_m - low) / width } else { 0.0 };
            let Some(adapted) = Span::new(segment, &place, counts) else { continue };
            span = adapted;
        }
        let estimate = span.estimate();
        if estimate == 0.0
            && let Some(reach) = span.reach(counts).filter(|reach| reach.exact())
        {
            problem.tell(0.0);
            return Look::Exact { place, pressures_pa: reach.phases.iter().map(|phase| phase.pressure_pa).collect() };
        }
        ranked.push((estimate, place));
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    Look::Ranked(ranked.into_iter().map(|(_, place)| place).collect())
}

/// The best geometry of a segment with pressures of its own; `None` where the model answers nowhere.
pub(super) fn separate(
    segment: &Segment,
    index: usize,
    effort: &Effort,
    watch: &mut dyn FnMut(&Progress),
) -> Option<Found> {
    let mut random = Random::new(effort.seed, index as u64);
    let mut problem = Watched::new(Separate { segment, counts: Counts::default() }, watch);
    let ranked = match look(&mut problem, &mut random) {
        Look::Exact { place, pressures_pa } => {
            let starts = Starts { made: 1, agreeing: 1 };
            return Some(Found { place, pressures_pa, objective: 0.0, starts, counts: problem.problem.counts });
        }
        Look::Ranked(ranked) => ranked,
    };
    // The best trials first, every second start from anywhere: a basin that starts high may end low.
    let next = |_: &mut Separate, start: usize| {
        let good = start.is_multiple_of(2).then(|| ranked.get(start / 2)).flatten();
        Some(good.cloned().unwrap_or_else(|| random.place(segment.dimensions())))
    };
    let stop = stop(scale([segment]));
    let (end, starts) = descend(&mut problem, effort, stop, next, |problem, end| settle(problem, end, stop))?;
    let pressures_pa = end.point.phases.iter().map(|phase| phase.pressure_pa).collect();
    let (objective, counts) = (end.objective, problem.problem.counts);
    Some(Found { place: end.place, pressures_pa, objective, starts, counts })
}

/// The best geometries of segments on one supply line; `None` where the model answers nowhere.
pub(super) fn shared(problem: &Problem, effort: &Effort, watch: &mut dyn FnMut(&Progress)) -> Option<Found> {
    let mut random = Random::new(effort.seed, 0);
    let mut limb = Watched::new(Shared { problem, counts: Counts::default() }, watch);
    // Every second start has pressures from anywhere: those that the segments would choose lead to the compromise nearest to them.
    let next = |limb: &mut Shared, start: usize| {
        let width = limb.dimensions();
        let mut place = if start == 0 { vec![0.5; width] } else { random.place(width) };
        let shares = if start.is_multiple_of(2) { limb.shares(&place)? } else { random.place(problem.phases()) };
        place.extend(shares);
        Some(place)
    };
    let effort = Effort { agreeing: effort.agreeing.max(ON_A_LINE), ..*effort };
    let (end, starts) = descend(&mut limb, &effort, stop(scale(&problem.segments)), next, |_, end| end)?;
    let (pressures_pa, objective) = (end.point.pressures_pa, end.objective);
    Some(Found { place: end.place, pressures_pa, objective, starts, counts: limb.problem.counts })
}
