//! Bounded nonlinear least squares on the unit box: damped Gauss-Newton with a secant for the curvature of the residuals.
//!
//! The model of the objective `f = sum r^2 / 2` is `g s + s (J'J + S + d I) s / 2`, `g = J'r`. `S` is the structured secant of Dennis, Gay and
//! Welsch: it starts at zero and learns `sum r_i grad^2 r_i` from the Jacobians that are there anyway, so that residuals that stay do not
//! slow the last steps down. It is used where it predicted the last step better than plain Gauss-Newton. `d` is the damping.

use nalgebra::{DMatrix, DVector};

const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e12;
/// Least diagonal that damps a variable, over the largest one.
const LEAST_SCALE: f64 = 1e-2;
/// Steps in a row below the least gain that end a local solve.
const IDLE: usize = 3;

/// Residuals on the unit box.
pub trait LeastSquares {
    /// State of the problem at a point.
    type Evaluation;
    /// Evaluates the problem at a point; `None` where it has no value.
    fn evaluate(&mut self, point: &[f64]) -> Option<Self::Evaluation>;
    /// The residuals.
    fn residuals(&self, evaluation: &Self::Evaluation) -> Vec<f64>;
    /// The Jacobian, a row for each residual.
    fn jacobian(&mut self, evaluation: &Self::Evaluation) -> Option<Vec<Vec<f64>>>;
}

/// A sum of squares on the unit box with its quadratic model; every [`LeastSquares`] is one.
pub trait SumOfSquares {
    /// State of the problem at a point.
    type Evaluation;
    /// Evaluates the problem at a point; `None` where it has no value.
    fn evaluate(&mut self, point: &[f64]) -> Option<Self::Evaluation>;
    /// `sum r^2`.
    fn objective(&self, evaluation: &Self::Evaluation) -> f64;
    /// The quadratic model.
    fn model(&mut self, evaluation: &Self::Evaluation) -> Option<Model>;
}

/// Quadratic model of an objective at a point.
#[derive(Clone, Debug)]
pub struct Model {
    /// `J'r`.
    pub gradient: DVector<f64>,
    /// `J'J`.
    pub normal: DMatrix<f64>,
    /// Jacobian and residuals, where the secant is to learn from them.
    pub residuals: Option<(DMatrix<f64>, DVector<f64>)>,
}

impl<L: LeastSquares> SumOfSquares for L {
    type Evaluation = L::Evaluation;

    fn evaluate(&mut self, point: &[f64]) -> Option<Self::Evaluation> {
        LeastSquares::evaluate(self, point)
    }

    fn objective(&self, evaluation: &Self::Evaluation) -> f64 {
        sum_of_squares(&self.residuals(evaluation))
    }

    fn model(&mut self, evaluation: &Self::Evaluation) -> Option<Model> {
        let rows = self.jacobian(evaluation)?;
        let residuals = DVector::from_vec(self.residuals(evaluation));
        let width = rows.first().map_or(0, Vec::len);
        let jacobian = DMatrix::from_fn(rows.len(), width, |i, j| rows[i][j]);
        let finite = jacobian.iter().chain(residuals.iter()).all(|value| value.is_finite());
        let (gradient, normal) = (jacobian.tr_mul(&residuals), jacobian.tr_mul(&jacobian));
        finite.then_some(Model { gradient, normal, residuals: Some((jacobian, residuals)) })
    }
}

/// Result of a local solve.
#[derive(Clone, Debug)]
pub struct Minimum<E> {
    /// Point of the unit box.
    pub point: Vec<f64>,
    /// State of the problem there.
    pub evaluation: E,
    /// `sum r^2`.
    pub objective: f64,
    /// Evaluations of the problem, that at the start included.
    pub evaluations: usize,
}

/// Ends of a local solve.
#[derive(Clone, Copy, Debug)]
pub struct StoppingCriteria {
    /// An objective that is as good as zero.
    pub zero: f64,
    /// Least relative reduction that a step must predict.
    pub relative: f64,
    /// Least relative reduction of a useful step: three in a row below it end the solve. 0 for no such end.
    pub least_gain: f64,
    /// Largest damping of a rejected step.
    pub damping: f64,
    /// Most evaluations.
    pub evaluations: usize,
    /// Whether each variable is damped by its own diagonal of the model, as Marquardt has it, not all of them by the largest one.
    pub by_diagonal: bool,
}

impl Default for StoppingCriteria {
    /// To the last digits, without a budget.
    fn default() -> Self {
        Self {
            zero: 0.0,
            relative: 1e-14,
            least_gain: 0.0,
            damping: MOST_DAMPING,
            evaluations: usize::MAX,
            by_diagonal: false,
        }
    }
}

/// The local minimum below a start in the box; `None` where the problem has no value at the start.
pub fn minimise<P: SumOfSquares>(
    problem: &mut P,
    start: &[f64],
    criteria: StoppingCriteria,
) -> Option<Minimum<P::Evaluation>> {
    let mut evaluation = problem.evaluate(start)?;
    let mut point = DVector::from_column_slice(start);
    let mut objective = problem.objective(&evaluation);
    let width = start.len();
    let (mut secant, mut with_secant) = (DMatrix::zeros(width, width), false);
    let (mut evaluations, mut idle) = (1, 0);
    let mut damping = 1e-3;
    let mut model = None;
    let mut lowered = None;
    while evaluations < criteria.evaluations && objective > criteria.zero {
        if criteria.least_gain > 0.0 && idle >= IDLE {
            break;
        }
        let Some(here) = model.take().or_else(|| problem.model(&evaluation)) else { break };
        let hessian = if with_secant { &here.normal + &secant } else { here.normal.clone() };
        let Some((step, predicted)) = bounded_step(&hessian, &here, &point, &mut damping, criteria.by_diagonal) else {
            break;
        };
        if predicted <= criteria.relative * objective {
            // No reduction is left at this damping; without damping there may be. Where the step has raised a lowered damping, none is.
            if damping <= LEAST_DAMPING || predicted == 0.0 || lowered.is_some_and(|lowered| damping > lowered) {
                break;
            }
            damping = (damping * 1e-3).max(LEAST_DAMPING);
            lowered = Some(damping);
            idle += 1;
            model = Some(here);
            continue;
        }
        let there = (&point + &step).map(|x| x.clamp(0.0, 1.0));
        let next = problem.evaluate(there.as_slice());
        evaluations += 1;
        lowered = None;
        let reached = next.as_ref().map_or(f64::INFINITY, |next| problem.objective(next));
        let actual = objective - reached;
        let gain = actual / predicted;
        let Some(next) = next.filter(|_| gain > 1e-4) else {
            damping *= if gain.is_finite() && gain > -1.0 { 4.0 } else { 10.0 };
            if damping > criteria.damping {
                break;
            }
            // A secant that has misled waits until it predicts better.
            with_secant = false;
            model = Some(here);
            continue;
        };
        damping = if gain > 0.75 {
            damping * 0.1
        } else if gain < 0.25 {
            damping * 3.0
        } else {
            damping
        };
        damping = damping.clamp(LEAST_DAMPING, criteria.damping);
        idle = if actual < criteria.least_gain * objective { idle + 1 } else { 0 };
        let Some(new) = problem.model(&next) else { break };
        if new.residuals.is_some() {
            let error = |hessian: &DMatrix<f64>| (reduction(hessian, &here.gradient, &step) - actual).abs();
            with_secant = error(&(&here.normal + &secant)) <= error(&here.normal);
            learn(&mut secant, &here, &new, &step);
        }
        (point, evaluation, objective, model) = (there, next, reached, Some(new));
    }
    Some(Minimum { point: point.as_slice().to_vec(), evaluation, objective, evaluations })
}

/// `sum r^2`.
pub fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Reduction of `sum r^2` by a step, as the quadratic model predicts it.
fn reduction(hessian: &DMatrix<f64>, gradient: &DVector<f64>, step: &DVector<f64>) -> f64 {
    -2.0 * gradient.dot(step) - step.dot(&(hessian * step))
}

/// The step to the minimum of the damped model within the box, and its predicted reduction. Variables that the step would push out of the
/// box are held at its faces, and the others adapted to that.
fn bounded_step(
    hessian: &DMatrix<f64>,
    model: &Model,
    point: &DVector<f64>,
    damping: &mut f64,
    by_diagonal: bool,
) -> Option<(DVector<f64>, f64)> {
    let width = point.len();
    let gradient = &model.gradient;
    let scale = model.normal.diagonal().max().max(f64::MIN_POSITIVE);
    let least = if by_diagonal { LEAST_SCALE } else { 1.0 };
    let scales = model.normal.diagonal().map(|own| own.max(least * scale));
    while *damping <= MOST_DAMPING {
        let mut step = DVector::zeros(width);
        let outwards = |i: usize| (point[i] <= 0.0 && gradient[i] >= 0.0) || (point[i] >= 1.0 && gradient[i] <= 0.0);
        let mut free: Vec<usize> = (0..width).filter(|i| !outwards(*i)).collect();
        let solved = loop {
            if free.is_empty() {
                break true;
            }
            let damped = |i: usize, j: usize| hessian[(i, j)] + if i == j { *damping * scales[i] } else { 0.0 };
            let block = DMatrix::from_fn(free.len(), free.len(), |i, j| damped(free[i], free[j]));
            let held = hessian * &step;
            let right = DVector::from_fn(free.len(), |i, _| -gradient[free[i]] - held[free[i]]);
            let Some(cholesky) = block.cholesky() else { break false };
            let found = cholesky.solve(&right);
            let out: Vec<usize> =
                (0..free.len()).filter(|i| !(-point[free[*i]]..=1.0 - point[free[*i]]).contains(&found[*i])).collect();
            if out.is_empty() {
                free.iter().zip(found.iter()).for_each(|(i, value)| step[*i] = *value);
                break true;
            }
            out.iter().for_each(|i| step[free[*i]] = found[*i].clamp(-point[free[*i]], 1.0 - point[free[*i]]));
            let mut index = 0;
            free.retain(|_| {
                index += 1;
                !out.contains(&(index - 1))
            });
        };
        let predicted = reduction(hessian, gradient, &step);
        if solved && predicted >= 0.0 {
            return Some((step, predicted));
        }
        *damping *= 10.0;
    }
    None
}

/// The update of Dennis, Gay and Welsch, with their sizing; none without residuals.
fn learn(secant: &mut DMatrix<f64>, here: &Model, there: &Model, step: &DVector<f64>) {
    let (Some((before, _)), Some((after, residuals))) = (&here.residuals, &there.residuals) else { return };
    let desired = (after - before).tr_mul(residuals);
    let turned = &there.gradient - &here.gradient;
    let along = turned.dot(step);
    if along.abs() <= 1e-12 * turned.norm() * step.norm() {
        return;
    }
    let present = step.dot(&(&*secant * step));
    if present != 0.0 {
        *secant *= (step.dot(&desired) / present).abs().min(1.0);
    }
    let missing = desired - &*secant * step;
    let cross = &missing * turned.transpose();
    *secant +=
        (&cross + cross.transpose()) / along - &turned * turned.transpose() * (missing.dot(step) / along.powi(2));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals of a closed form.
    struct Formula<R, J>(R, J);

    impl<R: Fn(&[f64]) -> Vec<f64>, J: Fn(&[f64]) -> Vec<Vec<f64>>> LeastSquares for Formula<R, J> {
        type Evaluation = Vec<f64>;
        fn evaluate(&mut self, point: &[f64]) -> Option<Vec<f64>> {
            Some(point.to_vec())
        }
        fn residuals(&self, at: &Vec<f64>) -> Vec<f64> {
            (self.0)(at)
        }
        fn jacobian(&mut self, at: &Vec<f64>) -> Option<Vec<Vec<f64>>> {
            Some((self.1)(at))
        }
    }

    fn to_the_end() -> StoppingCriteria {
        StoppingCriteria { zero: 1e-28, evaluations: 200, ..StoppingCriteria::default() }
    }

    #[test]
    fn valley_of_rosenbrock_is_followed_to_its_end() {
        // In the unit box: x = 4a - 2, y = 4b - 2; the minimum is at (1, 1).
        let r = |p: &[f64]| {
            let [x, y] = [4.0 * p[0] - 2.0, 4.0 * p[1] - 2.0];
            vec![10.0 * (y - x * x), 1.0 - x]
        };
        let j = |p: &[f64]| {
            let x = 4.0 * p[0] - 2.0;
            vec![vec![-80.0 * x, 40.0], vec![-4.0, 0.0]]
        };
        let end = minimise(&mut Formula(r, j), &[0.2, 0.75], to_the_end()).unwrap();
        assert!(end.objective < 1e-20 && (end.point[0] - 0.75).abs() < 1e-9, "{:?}", end.point);
    }

    #[test]
    fn damping_by_diagonal_does_not_slow_a_variable_of_small_slope() {
        // Rosenbrock's valley beside a variable of another scale: 0.01 (c - 1/2) has its zero at c = 1/2.
        let r = |p: &[f64]| {
            let [x, y] = [4.0 * p[0] - 2.0, 4.0 * p[1] - 2.0];
            vec![10.0 * (y - x * x), 1.0 - x, 0.01 * (p[2] - 0.5)]
        };
        let j = |p: &[f64]| {
            let x = 4.0 * p[0] - 2.0;
            vec![vec![-80.0 * x, 40.0, 0.0], vec![-4.0, 0.0, 0.0], vec![0.0, 0.0, 0.01]]
        };
        let end = |by_diagonal| {
            let criteria =
                StoppingCriteria { zero: 1e-14, evaluations: 200, by_diagonal, ..StoppingCriteria::default() };
            minimise(&mut Formula(r, j), &[0.2, 0.75, 0.0], criteria).unwrap()
        };
        for by_diagonal in [false, true] {
            let end = end(by_diagonal);
            assert!((end.point[0] - 0.75).abs() < 1e-6 && (end.point[2] - 0.5).abs() < 1e-4, "{:?}", end.point);
        }
    }

    #[test]
    fn face_of_the_box_stops_the_descent_where_the_bounded_minimum_is() {
        // (a + b - 3)^2 + (a - b)^2/4 with a <= 1, b <= 1: the corner; with b pulled to 0.5 as well: along the face a = 1.
        let r = |p: &[f64]| vec![p[0] + p[1] - 3.0, 2.0 * (p[1] - 0.5)];
        let j = |_: &[f64]| vec![vec![1.0, 1.0], vec![0.0, 2.0]];
        let end = minimise(&mut Formula(r, j), &[0.1, 0.9], to_the_end()).unwrap();
        // d/db [(b-2)^2 + 4 (b-1/2)^2] = 0 at b = 0.8.
        assert!((end.point[0] - 1.0).abs() < 1e-15 && (end.point[1] - 0.8).abs() < 1e-7, "{:?}", end.point);
        assert!((end.objective - (1.44 + 0.36)).abs() < 1e-14);
    }

    #[test]
    fn residuals_that_stay_do_not_slow_the_end() {
        // Gauss-Newton alone converges linearly here: f'' = 2 (J'J + r r'') with r r'' of the size of J'J.
        let r = |p: &[f64]| vec![p[0] - 0.3, 1.0 + 1.5 * (p[0] - 0.5).powi(2)];
        let j = |p: &[f64]| vec![vec![1.0], vec![3.0 * (p[0] - 0.5)]];
        let end = minimise(&mut Formula(r, j), &[0.9], to_the_end()).unwrap();
        // The derivative of the objective by its closed form.
        let x = end.point[0];
        let slope = (x - 0.3) + (1.0 + 1.5 * (x - 0.5f64).powi(2)) * 3.0 * (x - 0.5);
        assert!(slope.abs() < 1e-6, "{x} {slope}");
    }

    #[test]
    fn a_least_gain_ends_a_slow_solve_early() {
        // A minimum of degree four at 0.5: Gauss-Newton halves the distance with each step.
        let r = |p: &[f64]| vec![(p[0] - 0.5).powi(2)];
        let j = |p: &[f64]| vec![vec![2.0 * (p[0] - 0.5)]];
        let criteria = StoppingCriteria { least_gain: 0.99, ..to_the_end() };
        let early = minimise(&mut Formula(r, j), &[0.9], criteria).unwrap();
        let full = minimise(&mut Formula(r, j), &[0.9], to_the_end()).unwrap();
        assert!(early.evaluations < full.evaluations && early.objective > full.objective);
        assert_eq!(
            minimise(&mut Formula(r, j), &[0.9], StoppingCriteria { evaluations: 3, ..to_the_end() })
                .unwrap()
                .evaluations,
            3
        );
    }

    #[test]
    fn solve_ends_where_a_variable_has_no_effect() {
        // The second column of the Jacobian is zero: each step without damping fails and raises it again.
        let r = |p: &[f64]| vec![p[0] - 0.3, 1.0];
        let j = |_: &[f64]| vec![vec![1.0, 0.0], vec![0.0, 0.0]];
        let end = minimise(&mut Formula(r, j), &[0.9, 0.5], StoppingCriteria::default()).unwrap();
        assert!((end.point[0] - 0.3).abs() < 1e-6 && (end.objective - 1.0).abs() < 1e-12, "{:?}", end.point);
    }
}
