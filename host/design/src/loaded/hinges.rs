//! Bounded least squares with one-sided residuals: each of them counts above zero alone.
//!
//! The model of the sum of squares keeps the hinges: `sum max(0, c + J s)^2` over the one-sided residuals beside `sum (r + J s)^2` over the others.
//! A step knows by it of a residual that it would raise above zero, and counts on none below. Gauss and Newton's model of the positive parts
//! alone sees the first one only after it has failed there. The model is convex; its damped minimum in the unit box is found by Newton's method, which
//! changes the residuals that count from one iteration to the next.

use nalgebra::{DMatrix, DVector};
use softlimb_numerics::least_squares::Minimum;

const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e12;
const FIRST_DAMPING: f64 = 1e-3;
/// Least diagonal that damps a variable, over the largest one.
const LEAST_SCALE: f64 = 1e-2;
/// Least part of its prediction that a step must gain.
const LEAST_GAIN: f64 = 1e-4;
/// Steps in a row below the least gain that end a local solve.
const IDLE: usize = 3;
/// Most trials over most steps.
const TRIALS: usize = 3;
/// Newton's iterations for a step, and halvings that find the least on the way of one.
const ITERATIONS: usize = 20;
const HALVINGS: usize = 40;

/// Residuals on the unit box.
pub(super) trait Hinged {
    /// State of the problem at a point.
    type Evaluation;
    /// Evaluates the problem at a point; `None` where it has no value.
    fn evaluate(&mut self, point: &[f64]) -> Option<Self::Evaluation>;
    /// The residuals, and whether each is one-sided.
    fn residuals(&self, evaluation: &Self::Evaluation) -> Vec<(f64, bool)>;
    /// The Jacobian, a row for each residual.
    fn jacobian(&mut self, evaluation: &Self::Evaluation) -> Option<DMatrix<f64>>;
}

/// Ends of a local solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// An objective that is as good as zero.
    pub(super) zero: f64,
    /// Least relative reduction that a step must predict.
    pub(super) relative: f64,
    /// Least relative reduction of a useful step: three in a row below it end the solve.
    pub(super) least_gain: f64,
    /// Most steps.
    pub(super) steps: usize,
}

struct Model {
    residuals: DVector<f64>,
    one_sided: Vec<bool>,
    jacobian: DMatrix<f64>,
}

/// The local minimum below a start in the box; `None` where the problem has no value at the start.
pub(super) fn minimise<P: Hinged>(problem: &mut P, start: &[f64], ends: Ends) -> Option<Minimum<P::Evaluation>> {
    let mut evaluation = problem.evaluate(start)?;
    let mut point = DVector::from_column_slice(start);
    let objective_of = |problem: &P, evaluation: &P::Evaluation| squares(problem.residuals(evaluation).into_iter());
    let mut objective = objective_of(problem, &evaluation);
    let (mut evaluations, mut idle, mut damping) = (1, 0, FIRST_DAMPING);
    let mut model: Option<Model> = None;
    let (mut steps, mut rejected) = (0, false);
    while steps < ends.steps && evaluations < TRIALS * ends.steps && objective > ends.zero && idle < IDLE {
        let Some(here) = model.take().or_else(|| Model::of(problem, &evaluation)) else { break };
        let (step, left) = here.step(&point, damping);
        let predicted = objective - left;
        if predicted <= ends.relative * objective {
            if damping <= LEAST_DAMPING {
                break;
            }
            // Without damping there may be a reduction.
            damping = (damping * 1e-3).max(LEAST_DAMPING);
            idle += 1;
            model = Some(here);
            continue;
        }
        let there = (&point + &step).map(|x| x.clamp(0.0, 1.0));
        let next = problem.evaluate(there.as_slice());
        evaluations += 1;
        let reached = next.as_ref().map_or(f64::INFINITY, |next| objective_of(problem, next));
        let actual = objective - reached;
        let gain = actual / predicted;
        let Some(next) = next.filter(|_| gain > LEAST_GAIN) else {
            rejected = true;
            damping *= if gain.is_finite() && gain > -1.0 { 4.0 } else { 10.0 };
            if damping > MOST_DAMPING {
                break;
            }
            model = Some(here);
            continue;
        };
        damping *= if gain > 0.75 {
            // Along a curved valley a tenth of it would be rejected again and again.
            if rejected { 0.3 } else { 0.1 }
        } else if gain < 0.25 {
            3.0
        } else {
            1.0
        };
        damping = damping.clamp(LEAST_DAMPING, MOST_DAMPING);
        idle = if actual < ends.least_gain * objective { idle + 1 } else { 0 };
        (point, evaluation, objective) = (there, next, reached);
        (steps, rejected) = (steps + 1, false);
    }
    Some(Minimum { point: point.as_slice().to_vec(), evaluation, objective, evaluations })
}

fn squares(residuals: impl Iterator<Item = (f64, bool)>) -> f64 {
    residuals.map(|(value, one_sided)| if one_sided { value.max(0.0) } else { value }.powi(2)).sum()
}

impl Model {
    fn of<P: Hinged>(problem: &mut P, evaluation: &P::Evaluation) -> Option<Self> {
        let jacobian = problem.jacobian(evaluation)?;
        let (residuals, one_sided): (Vec<f64>, Vec<bool>) = problem.residuals(evaluation).into_iter().unzip();
        let finite = jacobian.iter().chain(&residuals).all(|value| value.is_finite());
        finite.then(|| Self { residuals: DVector::from_vec(residuals), one_sided, jacobian })
    }

    /// The residuals that count where they have these values.
    fn counting(&self, values: &DVector<f64>) -> Vec<bool> {
        values.iter().zip(&self.one_sided).map(|(value, one_sided)| !one_sided || *value > 0.0).collect()
    }

    /// The sum of squares of values.
    fn squares(&self, values: &DVector<f64>) -> f64 {
        squares(values.iter().copied().zip(self.one_sided.iter().copied()))
    }

    /// The step to the minimum of the damped model in the box, and what the model leaves there.
    fn step(&self, point: &DVector<f64>, damping: f64) -> (DVector<f64>, f64) {
        let mut counting = self.counting(&self.residuals);
        let mut rows = self.rows(&counting);
        let diagonal = rows.tr_mul(&rows).diagonal();
        let scale = diagonal.max().max(f64::MIN_POSITIVE);
        let damped = diagonal.map(|own| damping * own.max(LEAST_SCALE * scale));
        let mut step = DVector::zeros(point.len());
        let mut here = self.residuals.clone();
        for _ in 0..ITERATIONS {
            let own: Vec<f64> = picked(&self.residuals, &counting);
            let gradient = rows.tr_mul(&DVector::from_vec(own));
            let mut hessian = rows.tr_mul(&rows);
            (0..point.len()).for_each(|axis| hessian[(axis, axis)] += damped[axis]);
            let Some(target) = bounded(&hessian, &gradient, point) else { break };
            let way = target - &step;
            let moved = &self.jacobian * &way;
            // Half of the slope of the damped model along the way: it rises.
            let slope = |share: f64| {
                let of = |((value, by), one_sided): ((&f64, &f64), &bool)| {
                    let there = value + by * share;
                    if *one_sided && there <= 0.0 { 0.0 } else { there * by }
                };
                let values = here.iter().zip(&moved).zip(&self.one_sided).map(of).sum::<f64>();
                values
                    + step
                        .iter()
                        .zip(&way)
                        .zip(&damped)
                        .map(|((step, way), by)| by * (step + way * share) * way)
                        .sum::<f64>()
            };
            let share = if slope(1.0) <= 0.0 { 1.0 } else { least(slope) };
            (step, here) = (&step + &way * share, &here + &moved * share);
            let after = self.counting(&here);
            if share == 1.0 && after == counting {
                break;
            }
            counting = after;
            rows = self.rows(&counting);
        }
        let left = self.squares(&here);
        (step, left)
    }

    /// The rows of the Jacobian that count.
    fn rows(&self, counting: &[bool]) -> DMatrix<f64> {
        let rows: Vec<usize> = (0..counting.len()).filter(|row| counting[*row]).collect();
        self.jacobian.select_rows(&rows)
    }
}

fn picked(values: &DVector<f64>, counting: &[bool]) -> Vec<f64> {
    values.iter().zip(counting).filter_map(|(value, counts)| counts.then_some(*value)).collect()
}

/// Where a slope that rises from 0 to 1 changes its sign.
fn least(slope: impl Fn(f64) -> f64) -> f64 {
    let halve = |[low, high]: [f64; 2], _| {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { [low, middle] } else { [middle, high] }
    };
    // The far end is beyond a limit that the way meets, which then counts.
    let [_, beyond] = (0..HALVINGS).fold([0.0, 1.0], halve);
    beyond
}

/// The step to the minimum of `g s + s H s/2` in the box: variables that it would push out are held at its faces, and the others adapted to that.
fn bounded(hessian: &DMatrix<f64>, gradient: &DVector<f64>, point: &DVector<f64>) -> Option<DVector<f64>> {
    let width = point.len();
    let mut step = DVector::zeros(width);
    let outwards = |i: usize| (point[i] <= 0.0 && gradient[i] >= 0.0) || (point[i] >= 1.0 && gradient[i] <= 0.0);
    let mut free: Vec<usize> = (0..width).filter(|i| !outwards(*i)).collect();
    while !free.is_empty() {
        let block = DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(free[i], free[j])]);
        let held = hessian * &step;
        let right = DVector::from_fn(free.len(), |i, _| -gradient[free[i]] - held[free[i]]);
        let found = block.cholesky()?.solve(&right);
        let ends = |i: usize| (-point[i], 1.0 - point[i]);
        let outside = |at: usize| {
            let (low, high) = ends(free[at]);
            !(low..=high).contains(&found[at])
        };
        let out: Vec<usize> = (0..free.len()).filter(|at| outside(*at)).collect();
        if out.is_empty() {
            free.iter().zip(found.iter()).for_each(|(i, value)| step[*i] = *value);
            break;
        }
        for at in &out {
            let (low, high) = ends(free[*at]);
            step[free[*at]] = found[*at].clamp(low, high);
        }
        let mut index = 0;
        free.retain(|_| {
            index += 1;
            !out.contains(&(index - 1))
        });
    }
    Some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals of a closed form.
    struct Formula<R, J>(R, J);

    impl<R: Fn(&[f64]) -> Vec<(f64, bool)>, J: Fn(&[f64]) -> DMatrix<f64>> Hinged for Formula<R, J> {
        type Evaluation = Vec<f64>;
        fn evaluate(&mut self, point: &[f64]) -> Option<Vec<f64>> {
            Some(point.to_vec())
        }
        fn residuals(&self, at: &Vec<f64>) -> Vec<(f64, bool)> {
            (self.0)(at)
        }
        fn jacobian(&mut self, at: &Vec<f64>) -> Option<DMatrix<f64>> {
            Some((self.1)(at))
        }
    }

    const ENDS: Ends = Ends { zero: 1e-24, relative: 1e-14, least_gain: 0.0, steps: 100 };

    #[test]
    fn step_knows_of_a_limit_that_it_would_pass() {
        // a + b = 1 with a <= 0.3, which is kept at the start: the minimum has a = 0.3 and b = 0.7 at least, a sum of squares of zero.
        let residuals = |p: &[f64]| vec![(p[0] + p[1] - 1.0, false), (10.0 * (p[0] - 0.3), true)];
        let jacobian = |_: &[f64]| DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 10.0, 0.0]);
        let mut problem = Formula(residuals, jacobian);
        let model = Model::of(&mut problem, &vec![0.2, 0.2]).unwrap();
        let (step, left) = model.step(&DVector::from_vec(vec![0.2, 0.2]), 1e-9);
        assert!(left < 1e-12, "{left}");
        assert!(0.2 + step[0] <= 0.3 + 1e-6 && (0.4 + step.sum() - 1.0).abs() < 1e-6, "{step}");
        let end = minimise(&mut problem, &[0.2, 0.2], ENDS).unwrap();
        assert!(end.objective < 1e-20, "{}", end.objective);
    }

    #[test]
    fn limits_that_exclude_each_other_share_what_is_left() {
        // a <= 0.2 and a >= 0.6: the least sum of squares is 2 0.2^2, in the middle.
        let residuals = |p: &[f64]| vec![(p[0] - 0.2, true), (0.6 - p[0], true)];
        let jacobian = |_: &[f64]| DMatrix::from_row_slice(2, 1, &[1.0, -1.0]);
        let end = minimise(&mut Formula(residuals, jacobian), &[0.95], ENDS).unwrap();
        assert!((end.point[0] - 0.4).abs() < 1e-6 && (end.objective - 0.08).abs() < 1e-9, "{:?}", end.point);
    }

    #[test]
    fn valley_of_rosenbrock_ends_where_a_limit_bars_it() {
        // In the unit box x = 4a - 2, y = 4b - 2 with x <= 1/2 and nothing else in the way: least is 1/4 at (1/2, 1/4) but for the give of the limit.
        let scaled = |p: &[f64]| [4.0 * p[0] - 2.0, 4.0 * p[1] - 2.0];
        let residuals = |p: &[f64]| {
            let [x, y] = scaled(p);
            vec![(10.0 * (y - x * x), false), (1.0 - x, false), (1e3 * (x - 0.5), true)]
        };
        let jacobian = |p: &[f64]| {
            let [x, _] = scaled(p);
            DMatrix::from_row_slice(3, 2, &[-80.0 * x, 40.0, -4.0, 0.0, 4e3, 0.0])
        };
        let end = minimise(&mut Formula(residuals, jacobian), &[0.2, 0.75], ENDS).unwrap();
        let [x, y] = scaled(&end.point);
        assert!((x - 0.5).abs() < 1e-5 && (y - 0.25).abs() < 1e-4 && (end.objective - 0.25).abs() < 1e-5, "{x} {y}");
    }
}
