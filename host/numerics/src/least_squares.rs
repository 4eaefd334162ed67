//! Bounded nonlinear least squares on the unit box: Gauss-Newton with damping and a secant for what the residuals' curvature adds.
//!
//! The model of the objective `f = sum r^2 / 2` is `g s + s (J'J + S + d I) s / 2`, `g = J'r`. `S` is the structured secant of Dennis, Gay and
//! Welsch: it starts at zero and learns `sum r_i grad^2 r_i` from the Jacobians that are there anyway, so that residuals that stay do not
//! slow the last steps down. It is used where it foretold the last step better than plain Gauss-Newton. `d` is the damping.

use nalgebra::{DMatrix, DVector};

const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e12;

/// Residuals on the unit box.
pub trait LeastSquares {
    /// What is known at one place.
    type Point;
    /// `None` where there is no answer.
    fn at(&mut self, place: &[f64]) -> Option<Self::Point>;
    /// The residuals there.
    fn residuals(&self, point: &Self::Point) -> Vec<f64>;
    /// The Jacobian there, a row for each residual.
    fn rows(&mut self, point: &Self::Point) -> Option<Vec<Vec<f64>>>;
}

/// Where a descent ended.
pub struct Descent<P> {
    /// Point of the unit box.
    pub place: Vec<f64>,
    /// Result of the problem there.
    pub point: P,
    /// `sum r^2`.
    pub objective: f64,
}

/// When to be content.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// An objective that is as good as zero.
    pub zero: f64,
    /// The least relative improvement that a step must foretell.
    pub relative: f64,
    /// The most steps, those that are refused included.
    pub steps: usize,
}

/// The quadratic model at one place.
struct Model {
    jacobian: DMatrix<f64>,
    residuals: DVector<f64>,
    gradient: DVector<f64>,
    normal: DMatrix<f64>,
}

impl Model {
    fn new<L: LeastSquares>(problem: &mut L, point: &L::Point) -> Option<Self> {
        let rows = problem.rows(point)?;
        let residuals = DVector::from_vec(problem.residuals(point));
        let width = rows.first().map_or(0, Vec::len);
        let jacobian = DMatrix::from_fn(rows.len(), width, |i, j| rows[i][j]);
        let finite = jacobian.iter().chain(residuals.iter()).all(|value| value.is_finite());
        let (gradient, normal) = (jacobian.tr_mul(&residuals), jacobian.tr_mul(&jacobian));
        finite.then_some(Self { jacobian, residuals, gradient, normal })
    }
}

/// Goes down from a place of the box; `None` where there is no answer at the start.
pub fn minimise<L: LeastSquares>(problem: &mut L, start: &[f64], stop: Stop) -> Option<Descent<L::Point>> {
    let mut point = problem.at(start)?;
    let mut place = DVector::from_column_slice(start);
    let mut objective = sum_of_squares(&problem.residuals(&point));
    let width = start.len();
    let (mut secant, mut with_secant) = (DMatrix::zeros(width, width), false);
    let mut damping = 1e-3;
    let mut model = None;
    for _ in 0..stop.steps {
        if objective <= stop.zero {
            break;
        }
        let Some(here) = model.take().or_else(|| Model::new(problem, &point)) else { break };
        let hessian = if with_secant { &here.normal + &secant } else { here.normal.clone() };
        let scale = here.normal.diagonal().max().max(f64::MIN_POSITIVE);
        let Some((step, foretold)) = bounded_step(&hessian, &here.gradient, &place, &mut damping, scale) else { break };
        if foretold <= stop.relative * objective {
            // Nothing is left to gain at this damping; without damping there may be.
            if damping <= LEAST_DAMPING || foretold == 0.0 {
                break;
            }
            damping = (damping * 1e-3).max(LEAST_DAMPING);
            model = Some(here);
            continue;
        }
        let there = (&place + &step).map(|x| x.clamp(0.0, 1.0));
        let next = problem.at(there.as_slice());
        let reached = next.as_ref().map_or(f64::INFINITY, |next| sum_of_squares(&problem.residuals(next)));
        let gain = (objective - reached) / foretold;
        let Some(next) = next.filter(|_| gain > 1e-4) else {
            damping *= if gain.is_finite() && gain > -1.0 { 4.0 } else { 10.0 };
            if damping > MOST_DAMPING {
                break;
            }
            // A secant that has misled is not asked again until it does better.
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
        damping = damping.clamp(LEAST_DAMPING, MOST_DAMPING);
        let Some(new) = Model::new(problem, &next) else { break };
        let gained = objective - reached;
        let by = |hessian: &DMatrix<f64>| (foretold_by(hessian, &here.gradient, &step) - gained).abs();
        with_secant = by(&(&here.normal + &secant)) <= by(&here.normal);
        learn(&mut secant, &here, &new, &step);
        (place, point, objective, model) = (there, next, reached, Some(new));
    }
    Some(Descent { place: place.as_slice().to_vec(), point, objective })
}

/// `sum r^2`.
pub fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// How much a step lowers `sum r^2`, in the words of the model.
fn foretold_by(hessian: &DMatrix<f64>, gradient: &DVector<f64>, step: &DVector<f64>) -> f64 {
    -2.0 * gradient.dot(step) - step.dot(&(hessian * step))
}

/// The step to the minimum of the damped model within the box, and what it foretells. Variables that the step would push out of the box
/// are held at its faces, and the others adapted to that.
pub fn bounded_step(
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    place: &DVector<f64>,
    damping: &mut f64,
    scale: f64,
) -> Option<(DVector<f64>, f64)> {
    let width = place.len();
    while *damping <= MOST_DAMPING {
        let mut step = DVector::zeros(width);
        let outwards = |i: usize| (place[i] <= 0.0 && gradient[i] >= 0.0) || (place[i] >= 1.0 && gradient[i] <= 0.0);
        let mut free: Vec<usize> = (0..width).filter(|i| !outwards(*i)).collect();
        let solved = loop {
            if free.is_empty() {
                break true;
            }
            let damped = |i: usize, j: usize| hessian[(i, j)] + if i == j { *damping * scale } else { 0.0 };
            let block = DMatrix::from_fn(free.len(), free.len(), |i, j| damped(free[i], free[j]));
            let held = hessian * &step;
            let right = DVector::from_fn(free.len(), |i, _| -gradient[free[i]] - held[free[i]]);
            let Some(cholesky) = block.cholesky() else { break false };
            let found = cholesky.solve(&right);
            let out: Vec<usize> =
                (0..free.len()).filter(|i| !(-place[free[*i]]..=1.0 - place[free[*i]]).contains(&found[*i])).collect();
            if out.is_empty() {
                free.iter().zip(found.iter()).for_each(|(i, value)| step[*i] = *value);
                break true;
            }
            out.iter().for_each(|i| step[free[*i]] = found[*i].clamp(-place[free[*i]], 1.0 - place[free[*i]]));
            let mut index = 0;
            free.retain(|_| {
                index += 1;
                !out.contains(&(index - 1))
            });
        };
        let foretold = foretold_by(hessian, gradient, &step);
        if solved && foretold >= 0.0 {
            return Some((step, foretold));
        }
        *damping *= 10.0;
    }
    None
}

/// The update of Dennis, Gay and Welsch, with their sizing.
fn learn(secant: &mut DMatrix<f64>, here: &Model, there: &Model, step: &DVector<f64>) {
    let wanted = (&there.jacobian - &here.jacobian).tr_mul(&there.residuals);
    let turned = &there.gradient - &here.gradient;
    let along = turned.dot(step);
    if along.abs() <= 1e-12 * turned.norm() * step.norm() {
        return;
    }
    let held = step.dot(&(&*secant * step));
    if held != 0.0 {
        *secant *= (step.dot(&wanted) / held).abs().min(1.0);
    }
    let missing = wanted - &*secant * step;
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
        type Point = Vec<f64>;
        fn at(&mut self, place: &[f64]) -> Option<Vec<f64>> {
            Some(place.to_vec())
        }
        fn residuals(&self, point: &Vec<f64>) -> Vec<f64> {
            (self.0)(point)
        }
        fn rows(&mut self, point: &Vec<f64>) -> Option<Vec<Vec<f64>>> {
            Some((self.1)(point))
        }
    }

    const STOP: Stop = Stop { zero: 1e-28, relative: 1e-14, steps: 200 };

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
        let end = minimise(&mut Formula(r, j), &[0.2, 0.75], STOP).unwrap();
        assert!(end.objective < 1e-20 && (end.place[0] - 0.75).abs() < 1e-9, "{:?}", end.place);
    }

    #[test]
    fn face_of_the_box_stops_the_descent_where_the_bounded_minimum_is() {
        // (a + b - 3)^2 + (a - b)^2/4 with a <= 1, b <= 1: the corner; with b pulled to 0.5 as well: along the face a = 1.
        let r = |p: &[f64]| vec![p[0] + p[1] - 3.0, 2.0 * (p[1] - 0.5)];
        let j = |_: &[f64]| vec![vec![1.0, 1.0], vec![0.0, 2.0]];
        let end = minimise(&mut Formula(r, j), &[0.1, 0.9], STOP).unwrap();
        // d/db [(b-2)^2 + 4 (b-1/2)^2] = 0 at b = 0.8.
        assert!((end.place[0] - 1.0).abs() < 1e-15 && (end.place[1] - 0.8).abs() < 1e-7, "{:?}", end.place);
        assert!((end.objective - (1.44 + 0.36)).abs() < 1e-14);
    }

    #[test]
    fn residuals_that_stay_do_not_slow_the_end() {
        // Gauss-Newton alone converges linearly here: f'' = 2 (J'J + r r'') with r r'' of the size of J'J.
        let r = |p: &[f64]| vec![p[0] - 0.3, 1.0 + 1.5 * (p[0] - 0.5).powi(2)];
        let j = |p: &[f64]| vec![vec![1.0], vec![3.0 * (p[0] - 0.5)]];
        let end = minimise(&mut Formula(r, j), &[0.9], STOP).unwrap();
        // The derivative of the objective by its closed form.
        let x = end.place[0];
        let slope = (x - 0.3) + (1.0 + 1.5 * (x - 0.5f64).powi(2)) * 3.0 * (x - 0.5);
        assert!(slope.abs() < 1e-6, "{x} {slope}");
    }
}
