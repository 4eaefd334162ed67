//! The ridge where the highest pressure of the bounds meets the margin to the limit point.
//!
//! The pressure of a phase that wants more than it gets is `min(P_max, (1 - margin) P_limit)`. The best geometry is often one where both
//! are equal: `g(x) = (1 - margin) P_limit(x)/P_max - 1 = 0`. The objective has a kink there, along which a local solve that knows one side at a
//! time stops anywhere. So the side is given up: one variable `x_k` follows from the others by `g = 0`, and what is left is smooth,
//!
//! ```text
//! dr/dx_j = (dr/dx_j)_g - (dr/dx_k)_g (dg/dx_j)/(dg/dx_k)
//! ```
//!
//! with the derivatives `_g` at the pressure `P_max`.

use super::actuator::{Candidate, Cap, Counts};
use super::reach::{Held, Reach, Separate, Span};
use super::search::Watched;
use softlimb_numerics::least_squares::{LeastSquares, Minimum, StoppingCriteria, minimise};

/// Local solves that end with `g` as small may have been stopped by the ridge.
const NEAR: f64 = 0.05;
/// Distance from the ridge at which a local solve tries the other side, as a share of the box.
const ASIDE: f64 = 1e-3;
/// Evaluations of that solve: it goes on in the next round where it does better.
const LOOK: usize = 16;
const ROUNDS: usize = 4;
const STEPS: usize = 60;
/// Values of a variable as near to each other are one: limit points are not known better.
const SAME: f64 = 1e-13;

/// `g` at a point, and its derivatives by the variables of the unit box.
struct Gap {
    value: f64,
    slopes: [f64; 4],
}

/// `None` where there is no limit point up to twice the highest pressure.
fn gap(candidate: &Candidate, counts: &mut Counts) -> Option<Gap> {
    let highest = candidate.segment.pressure_max_pa;
    let cap = candidate.margin(2.0 * highest, counts)?;
    let slopes = candidate.cap_by_place(&cap, counts)?;
    Some(Gap { value: cap.pressure_pa / highest - 1.0, slopes: slopes.map(|slope| slope / highest) })
}

/// The least squares of a segment on the ridge, in all variables but one.
struct Ridge<'p, 'a> {
    separate: &'p mut Separate<'a>,
    follows: usize,
    /// Where the variable that follows was last.
    last: f64,
}

/// A geometry on the ridge.
struct OnRidge<'a> {
    point: Vec<f64>,
    reach: Reach<'a>,
    slopes: [f64; 4],
}

impl<'a> Ridge<'_, 'a> {
    /// The point on the ridge with the other variables as they are: Newton's method, within a range that is halved where it fails.
    fn complete(&mut self, others: &[f64]) -> Option<(Candidate<'a>, Vec<f64>, [f64; 4])> {
        let mut point = others.to_vec();
        point.insert(self.follows, self.last);
        let mut range = [0.0, 1.0];
        for _ in 0..STEPS {
            let candidate = Candidate::new(self.separate.segment, &point)?;
            let gap = gap(&candidate, &mut self.separate.counts)?;
            let (x, slope) = (point[self.follows], gap.slopes[self.follows]);
            let next = x - gap.value / slope;
            if !next.is_finite() {
                return None;
            }
            // On which side of here the ridge is.
            range[usize::from(next < x)] = x;
            let beyond = (x == 0.0 && next < 0.0) || (x == 1.0 && next > 1.0);
            if beyond || range[1] - range[0] < SAME {
                return None;
            }
            let step = next.clamp(0.0, 1.0);
            let step = if (range[0]..=range[1]).contains(&step) { step } else { 0.5 * (range[0] + range[1]) };
            if (step - x).abs() <= SAME {
                self.last = x;
                return Some((candidate, point, gap.slopes));
            }
            point[self.follows] = step;
        }
        None
    }
}

impl<'a> LeastSquares for Ridge<'_, 'a> {
    type Evaluation = OnRidge<'a>;

    fn evaluate(&mut self, others: &[f64]) -> Option<OnRidge<'a>> {
        let (candidate, point, slopes) = self.complete(others)?;
        let cap = Cap { pressure_pa: candidate.segment.pressure_max_pa, limit: None };
        let counts = &mut self.separate.counts;
        counts.evaluations += 1;
        let reach = Span::with_cap(candidate, cap, counts)?.reach(counts)?;
        Some(OnRidge { point, reach, slopes })
    }

    fn residuals(&self, on_ridge: &OnRidge<'a>) -> Vec<f64> {
        self.separate.residuals(&on_ridge.reach)
    }

    fn jacobian(&mut self, on_ridge: &OnRidge<'a>) -> Option<Vec<Vec<f64>>> {
        let mut rows = self.separate.jacobian(&on_ridge.reach)?;
        for row in &mut rows {
            let following = row[self.follows] / on_ridge.slopes[self.follows];
            row.iter_mut().zip(on_ridge.slopes).for_each(|(row, slope)| *row -= following * slope);
            row.remove(self.follows);
        }
        Some(rows)
    }
}

/// Goes on from a local minimum where the solve may have been stopped by the ridge: along the ridge, and from there to both sides.
pub(super) fn settle<'a>(
    problem: &mut Watched<Separate<'a>>,
    mut best: Minimum<Reach<'a>>,
    criteria: StoppingCriteria,
) -> Minimum<Reach<'a>> {
    for _ in 0..ROUNDS {
        if best.objective <= criteria.zero || !stopped(&mut problem.problem, &best) {
            break;
        }
        let before = best.objective;
        // The wall first: the limit point depends most on it.
        for follows in [1, 0, 3] {
            let along = along(&mut problem.problem, &best.point, follows, criteria);
            take(problem, &mut best, along);
        }
        if best.objective < before * (1.0 - 1e-12) {
            continue;
        }
        for point in aside(&mut problem.problem, &best.point) {
            let other = minimise(problem, &point, StoppingCriteria { evaluations: LOOK, ..criteria });
            take(problem, &mut best, other);
        }
        if best.objective >= before * (1.0 - 1e-12) {
            break;
        }
    }
    best
}

fn take<'a>(problem: &mut Watched<Separate<'a>>, best: &mut Minimum<Reach<'a>>, other: Option<Minimum<Reach<'a>>>) {
    if let Some(other) = other.filter(|other| other.objective < best.objective) {
        problem.tell(other.objective);
        *best = other;
    }
}

/// Whether a phase wants more pressure than it gets, near the ridge.
fn stopped(problem: &mut Separate, minimum: &Minimum<Reach>) -> bool {
    let wants_more = minimum.evaluation.phases.iter().any(|phase| phase.held == Held::Highest);
    wants_more
        && !problem.segment.bends_without_limit()
        && Candidate::new(problem.segment, &minimum.point)
            .and_then(|candidate| gap(&candidate, &mut problem.counts))
            .is_some_and(|gap| gap.value.abs() < NEAR)
}

fn along<'a>(
    problem: &mut Separate<'a>,
    point: &[f64],
    follows: usize,
    criteria: StoppingCriteria,
) -> Option<Minimum<Reach<'a>>> {
    if follows >= point.len() || problem.segment.axis(follows)[1] == 0.0 {
        return None;
    }
    let mut others = point.to_vec();
    let last = others.remove(follows);
    let minimum = minimise(&mut Ridge { separate: problem, follows, last }, &others, criteria)?;
    let Minimum { evaluation: OnRidge { point, reach, .. }, objective, evaluations, .. } = minimum;
    Some(Minimum { point, evaluation: reach, objective, evaluations })
}

/// A point on each side of the ridge.
fn aside(problem: &mut Separate, point: &[f64]) -> Vec<Vec<f64>> {
    let gap = Candidate::new(problem.segment, point).and_then(|candidate| gap(&candidate, &mut problem.counts));
    let Some(Gap { slopes, .. }) = gap else { return Vec::new() };
    let steepest = slopes.iter().fold(f64::MIN_POSITIVE, |most, slope| most.max(slope.abs()));
    let moved = |sign: f64| {
        let along = |(x, slope): (&f64, &f64)| (x + sign * ASIDE * slope / steepest).clamp(0.0, 1.0);
        point.iter().zip(&slopes).map(along).collect()
    };
    vec![moved(1.0), moved(-1.0)]
}
