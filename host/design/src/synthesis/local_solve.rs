//! Local solves of the objective, over some or all of the variables.

use nalgebra::{DMatrix, DVector};

use super::objective::{Objective, Quadratic};
use softlimb_numerics::least_squares::{Model, StoppingCriteria, SumOfSquares, minimise};

/// Damping at which a local solve is stuck: objectives with obstacles have kinks.
const STUCK: f64 = 1e8;

/// The criteria of a local solve: an objective as good as zero, mm2, the least relative reduction of a useful step, and the most evaluations.
pub(super) fn criteria(zero: f64, least_gain: f64, evaluations: usize) -> StoppingCriteria {
    StoppingCriteria { zero, relative: 1e-14, least_gain, damping: STUCK, evaluations, by_diagonal: false }
}

/// Moves `place` to the local minimum below it, in the variables of `free` only; gives the objective there and the evaluations spent.
pub(super) fn solve(
    objective: &Objective,
    place: &mut [f64],
    free: &[usize],
    criteria: StoppingCriteria,
) -> (f64, usize) {
    let start: Vec<f64> = free.iter().map(|index| place[*index]).collect();
    let mut restricted = Restricted { objective, place: place.to_vec(), free };
    let Some(minimum) = minimise(&mut restricted, &start, criteria) else { return (f64::INFINITY, 1) };
    free.iter().zip(&minimum.point).for_each(|(index, value)| place[*index] = *value);
    (minimum.objective, minimum.evaluations)
}

/// The objective as a function of its free variables.
struct Restricted<'o, 'a> {
    objective: &'o Objective<'a>,
    /// All variables.
    place: Vec<f64>,
    free: &'o [usize],
}

impl SumOfSquares for Restricted<'_, '_> {
    type Evaluation = Quadratic;

    fn evaluate(&mut self, point: &[f64]) -> Option<Quadratic> {
        self.free.iter().zip(point).for_each(|(index, value)| self.place[*index] = *value);
        Some(self.objective.at(&self.place))
    }

    fn objective(&self, all: &Quadratic) -> f64 {
        all.value
    }

    fn model(&mut self, all: &Quadratic) -> Option<Model> {
        let free = self.free;
        let gradient = DVector::from_iterator(free.len(), free.iter().map(|index| all.gradient[*index]));
        let normal = DMatrix::from_fn(free.len(), free.len(), |i, j| all.normal[(free[i], free[j])]);
        Some(Model { gradient, normal, residuals: None })
    }
}
