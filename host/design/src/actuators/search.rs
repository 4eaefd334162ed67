//! Local solves of a search, and the number of minima that must agree.

use serde::Serialize;

use super::actuator::Counts;
use super::along::along;
use super::grid::Grid;
use super::hops::HOPS;
use super::problem::{Problem, Segment};
use super::reach::{Separate, Span};
use super::ridge;
use super::settle::settle;
use super::shared::Shared;
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::{LeastSquares, StoppingCriteria, minimise, sum_of_squares};
use softlimb_numerics::multi_start::{LocalSolves, MultiStart, multi_start};

/// Geometries that are looked at before any local solve.
const TRIALS: usize = 24;
/// The first of them: the middle of the bounds, then towards wide and thin sections, which deform most; the rest are random. Lengths adapt.
const LOOKED_AT: [[f64; 4]; 5] =
    [[0.5, 0.5, 0.5, 0.5], [0.8, 0.2, 0.7, 0.5], [1.0, 0.0, 1.0, 0.5], [1.0, 0.0, 1.0, 0.0], [1.0, 0.0, 1.0, 1.0]];
/// As many minima at least must agree on one supply line: the best basin may be one that few starts lie in.
const ON_A_LINE: usize = 16;
/// Share of the evaluations that starting points may take on a supply line; the others are for hops from the best minimum.
const STARTING: f64 = 0.5;
/// Least model solves for each evaluation of the budget on a supply line. Where evaluations take fewer, the search makes more of them.
const SOLVES: f64 = 52.0;
/// Least relative gain of a step before the margins to limit points are settled.
const ROUGH: f64 = 1e-2;
/// The same while they are settled: differences are not exact to more.
const FINE: f64 = 1e-8;
/// Objectives within this share of each other agree.
pub(super) const SAME: f64 = 1e-6;

/// How long to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Seed of the starts.
    pub seed: u64,
    /// Most starts, of each segment or of the limb on one supply line; at least 1.
    pub starts: usize,
    /// As many local solves must end at the best objective before the search stops early; on one supply line at least sixteen.
    pub agreeing: usize,
    /// Evaluations after which no local solve begins. On one supply line the search also makes 52 model solves for each of them.
    pub evaluations: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { seed: 1, starts: 40, agreeing: 5, evaluations: 2500 }
    }
}

/// How the local solves of a search ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SolveCounts {
    /// Local solves made; a geometry that reaches every goal at once counts as one.
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

    /// Whether an evaluation is a design that may be made: within every margin to a limit point.
    fn is_allowed(&self, _: &Self::Evaluation) -> bool {
        true
    }
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
    type Evaluation = L::Evaluation;

    fn evaluate(&mut self, point: &[f64]) -> Option<L::Evaluation> {
        let evaluation = self.problem.evaluate(point)?;
        if self.problem.is_allowed(&evaluation) {
            self.tell(sum_of_squares(&self.problem.residuals(&evaluation)));
        }
        Some(evaluation)
    }

    fn residuals(&self, evaluation: &L::Evaluation) -> Vec<f64> {
        self.problem.residuals(evaluation)
    }

    fn jacobian(&mut self, evaluation: &L::Evaluation) -> Option<Vec<Vec<f64>>> {
        self.problem.jacobian(evaluation)
    }
}

/// The best of a search.
#[derive(Clone)]
pub(super) struct Found {
    /// Point of the geometry in its unit box, and of the shares behind it where there are.
    pub(super) point: Vec<f64>,
    pub(super) pressures_pa: Vec<f64>,
    pub(super) objective: f64,
    pub(super) starts: SolveCounts,
    pub(super) counts: Counts,
}

/// The size of the goals: `sum w q^2`.
fn scale<'a>(segments: impl IntoIterator<Item = &'a Segment>) -> f64 {
    let goals = segments.into_iter().flat_map(|segment| segment.goals.iter().flatten());
    goals.map(|goal| goal.weight * goal.value * goal.value).sum()
}

/// Criteria for goals of a size; one evaluation is that of the start.
fn criteria(scale: f64) -> StoppingCriteria {
    StoppingCriteria { zero: 1e-24 * scale, relative: 1e-16, evaluations: 201, ..StoppingCriteria::default() }
}

impl Budget {
    fn multi_start(&self, criteria: StoppingCriteria) -> MultiStart {
        MultiStart { starts: self.starts, agreeing: self.agreeing, same: SAME, criteria }
    }
}

impl From<LocalSolves> for SolveCounts {
    fn from(solves: LocalSolves) -> Self {
        Self { made: solves.minima, agreeing: solves.agreeing }
    }
}

/// What a look at some geometries of a segment gives.
enum Look {
    /// One has every goal.
    Exact { point: Vec<f64>, pressures_pa: Vec<f64> },
    /// None has; the points by what is left there, the least first.
    Ranked(Vec<Vec<f64>>),
}

/// Looks at some geometries, at a length within reach where there is one.
fn look(problem: &mut Watched<Separate>, random: &mut Random) -> Look {
    let segment = problem.problem.segment;
    let width = segment.dimensions();
    let mut ranked = Vec::new();
    for trial in 0..TRIALS {
        let mut point = LOOKED_AT.get(trial).map_or_else(|| random.point(width), |point| point[..width].to_vec());
        let counts = &mut problem.problem.counts;
        let Some(mut span) = Span::new(segment, &point, counts) else { continue };
        if let Some(length_m) = span.better_length().filter(|_| span.estimate() > 0.0) {
            let [low, width] = segment.axis(2);
            point[2] = if width > 0.0 { (length_m - low) / width } else { 0.0 };
            let Some(adapted) = Span::new(segment, &point, counts) else { continue };
            span = adapted;
        }
        let mut estimate = span.estimate();
        let has_effort = segment.effort_per_pa2 > 0.0;
        let reach = if estimate == 0.0 || has_effort { span.reach(counts) } else { None };
        if let Some(reach) = reach {
            if reach.exact() {
                let pressures_pa = reach.phases.iter().map(|phase| phase.pressure_pa).collect();
                problem.tell(0.0);
                return Look::Exact { point, pressures_pa };
            }
            if has_effort {
                estimate = sum_of_squares(&problem.residuals(&reach));
            }
        }
        ranked.push((estimate, point));
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    Look::Ranked(ranked.into_iter().map(|(_, point)| point).collect())
}

/// The best geometry of a segment with pressures of its own; `None` where the model answers nowhere.
pub(super) fn separate(
    segment: &Segment,
    index: usize,
    effort: &Budget,
    watch: &mut dyn FnMut(&Progress),
) -> Option<Found> {
    let mut random = Random::new(effort.seed, index as u64);
    let mut problem = Watched::new(Separate { segment, counts: Counts::default() }, watch);
    let ranked = match look(&mut problem, &mut random) {
        Look::Exact { point, pressures_pa } => {
            let starts = SolveCounts { made: 1, agreeing: 1 };
            return Some(Found { point, pressures_pa, objective: 0.0, starts, counts: problem.problem.counts });
        }
        Look::Ranked(ranked) => ranked,
    };
    // The best trials first, every second start from anywhere: a basin that starts high may end low.
    let start = |_: &mut Watched<Separate>, index: usize| {
        let good = index.is_multiple_of(2).then(|| ranked.get(index / 2)).flatten();
        Some(good.cloned().unwrap_or_else(|| random.point(segment.dimensions())))
    };
    let criteria = criteria(scale([segment]));
    let spent = |problem: &Watched<Separate>| problem.problem.counts.evaluations >= effort.evaluations;
    let refine = |problem: &mut Watched<_>, minimum| ridge::settle(problem, minimum, criteria);
    let (minimum, solves) = multi_start(&mut problem, effort.multi_start(criteria), spent, start, refine)?;
    let pressures_pa = minimum.evaluation.phases.iter().map(|phase| phase.pressure_pa).collect();
    let (objective, counts) = (minimum.objective, problem.problem.counts);
    Some(Found { point: minimum.point, pressures_pa, objective, starts: solves.into(), counts })
}

/// The best geometries of segments on one supply line; `None` where the model answers nowhere.
pub(super) fn shared(problem: &Problem, effort: &Budget, watch: &mut dyn FnMut(&Progress)) -> Option<Found> {
    let mut random = Random::new(effort.seed, 0);
    let mut limb = Watched::new(Shared::new(problem), watch);
    let grid = Grid::new(&problem.segments, limb.problem.highest_pa, &mut limb.problem.counts);
    let ranked = grid.starting_points(&mut random);
    // The best points of the grid first, every second start from anywhere: a basin that starts high may end low.
    let start = |limb: &mut Watched<Shared>, index: usize| {
        let limb = &mut limb.problem;
        if let Some(point) = index.is_multiple_of(2).then(|| ranked.get(index / 2)).flatten() {
            return limb.start_at(point.clone());
        }
        let shares = random.point(problem.phases());
        let at_random = || grid.point(&shares);
        if let Some(point) = (index % 4 == 1).then(at_random).flatten() {
            return limb.start_at(point);
        }
        let point = random.point(limb.dimensions());
        limb.start(point, shares)
    };
    let effort = Budget { agreeing: effort.agreeing.max(ON_A_LINE), ..*effort };
    let criteria = StoppingCriteria { relative: 1e-12, least_gain: FINE, ..criteria(scale(&problem.segments)) };
    let settings = effort.multi_start(StoppingCriteria { least_gain: ROUGH, ..criteria });
    let refine = |limb: &mut Watched<_>, rough| {
        let mut minimum = settle::<Shared>(&mut limb.problem, rough, criteria);
        let further = along(&mut limb.problem, &minimum.evaluation, criteria);
        if let Some(further) = further.filter(|further| further.objective < minimum.objective) {
            minimum = further;
        }
        limb.tell(minimum.objective);
        minimum
    };
    let evaluations = effort.evaluations as f64;
    let is_started = |limb: &Watched<Shared>| limb.problem.counts.evaluations as f64 >= STARTING * evaluations;
    let (mut minimum, mut solves) = multi_start(&mut limb, settings, is_started, start, refine)?;
    minimum.objective.is_finite().then_some(())?;
    let is_over = |limb: &Watched<Shared>, objective: f64| {
        let Counts { evaluations: made, solves, .. } = limb.problem.counts;
        objective <= criteria.zero || (made as f64).min(solves as f64 / SOLVES) >= evaluations
    };
    let (mut kind, mut fruitless) = (0, 0);
    while fruitless < HOPS.len() && !is_over(&limb, minimum.objective) {
        let mut points = HOPS[kind](&grid, &mut limb.problem, &minimum.point, minimum.objective);
        let mut is_better = false;
        // The best of them is tried even if finding them has spent the budget.
        while let Some(point) = points.pop() {
            let Some(point) = limb.problem.start_at(point) else { continue };
            let Some(rough) = minimise(&mut limb, &point, settings.criteria) else { continue };
            let found = refine(&mut limb, rough);
            solves.minima += 1;
            is_better = found.objective < minimum.objective * (1.0 - SAME);
            if is_better {
                // No start has ended there.
                (minimum, solves.agreeing) = (found, 1);
            } else if found.objective <= minimum.objective * (1.0 + SAME) {
                solves.agreeing += 1;
            }
            if is_better || is_over(&limb, minimum.objective) {
                break;
            }
        }
        (kind, fruitless) = if is_better { (kind, 0) } else { ((kind + 1) % HOPS.len(), fruitless + 1) };
    }
    let (pressures_pa, objective) = (minimum.evaluation.pressures_pa, minimum.objective);
    Some(Found { point: minimum.point, pressures_pa, objective, starts: solves.into(), counts: limb.problem.counts })
}
