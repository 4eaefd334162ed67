//! One local solve of the search: bounded least squares on what the margins lack.

use std::panic::resume_unwind;

use super::evaluate::{Evaluation, Judgement, evaluate, evaluate_beside};
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::least_squares::{LeastSquares, Minimum, StoppingCriteria, minimise};

/// Step of a derivative in the unit box.
const STEP: f64 = 2e-3;
/// A sum of squares that counts as nothing lacking: 0.03 mm, or 0.1 % of a limit, which the reserve covers.
pub(super) const NOTHING: f64 = 1e-5;

struct Problem<'a> {
    task: &'a LoadedTask,
    space: &'a LimbSpace,
    by: &'a Judgement,
    evaluations: usize,
    warm: Option<Evaluation>,
    /// Threads of a Jacobian.
    abreast: usize,
}

impl Problem<'_> {
    fn at(&mut self, point: &[f64]) -> Option<Evaluation> {
        self.evaluations += 1;
        evaluate(self.task, self.space, &self.space.sizes(point), self.by, self.warm.as_ref())
    }
}

impl Problem<'_> {
    /// Derivative of the residuals by one variable; zeros where the limb beside does not stand.
    fn column(&self, at: &At, here: &[f64], axis: usize) -> Vec<f64> {
        let step = if at.point[axis] > 0.5 { -STEP } else { STEP };
        let mut point = at.point.clone();
        point[axis] += step;
        match evaluate_beside(self.task, self.space, &self.space.sizes(&point), self.by, &at.limb) {
            Some(there) => there.lacks.iter().zip(here).map(|(there, here)| (there.value - here) / step).collect(),
            None => vec![0.0; here.len()],
        }
    }
}

/// A point with its limb.
pub(super) struct At {
    pub(super) point: Vec<f64>,
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

/// The limb that least squares lead to, and the limbs judged.
pub(super) fn local(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    by: &Judgement,
    (steps, abreast): (usize, usize),
) -> Option<(Minimum<At>, usize)> {
    let mut problem = Problem { task, space, by, evaluations: 0, warm: None, abreast };
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

/// Applies `work` to every item in its own thread; results keep the order of the items.
pub(super) fn abreast<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    std::thread::scope(|scope| {
        let handles: Vec<_> = items.iter().map(|item| scope.spawn(|| work(item))).collect();
        handles.into_iter().map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}
