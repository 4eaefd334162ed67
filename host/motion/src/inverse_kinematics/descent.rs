//! Local solves of a task, by the bounded least squares of `softlimb-numerics`.

use softlimb_numerics::least_squares::{Model, StoppingCriteria, SumOfSquares, minimise};

use super::ARRIVED_M;
use super::problem::{Linear, Problem, WEIGHTS};

/// A step that lessens the miss by less than 1e-7 of it is small.
const CRITERIA: StoppingCriteria = StoppingCriteria {
    zero: ARRIVED_M * ARRIVED_M,
    relative: 1e-14,
    least_gain: 2e-7,
    damping: 1e12,
    evaluations: 200,
    by_diagonal: false,
};

/// A problem with a weight of direction and clearance.
struct Weighted<'p, 'a, 'l> {
    problem: &'p Problem<'a, 'l>,
    weight: f64,
}

impl SumOfSquares for Weighted<'_, '_, '_> {
    type Evaluation = Linear;

    fn evaluate(&mut self, shares: &[f64]) -> Option<Linear> {
        self.problem.linear(shares, self.weight)
    }

    fn objective(&self, at: &Linear) -> f64 {
        at.residual.norm_squared()
    }

    /// Without a secant: residuals of obstacles come and go, and those of a solution vanish.
    fn model(&mut self, at: &Linear) -> Option<Model> {
        let (gradient, normal) = (at.jacobian.tr_mul(&at.residual), at.jacobian.tr_mul(&at.jacobian));
        Some(Model { gradient, normal, residuals: None })
    }
}

/// Goes down from a start in the unit box until the residuals vanish or no step helps; again with a larger weight where direction or
/// clearance are then missed.
pub(super) fn descend(problem: &Problem<'_, '_>, start: Vec<f64>) -> Vec<f64> {
    let start: Vec<f64> = start.into_iter().map(|share| share.clamp(0.0, 1.0)).collect();
    let [first, last] = WEIGHTS;
    let shares = descend_with(problem, start, first);
    if problem.reach(&shares).allowed() { shares } else { descend_with(problem, shares, last) }
}

/// The start where the limb does not stand there.
fn descend_with(problem: &Problem<'_, '_>, start: Vec<f64>, weight: f64) -> Vec<f64> {
    minimise(&mut Weighted { problem, weight }, &start, CRITERIA).map_or(start, |found| found.point)
}
