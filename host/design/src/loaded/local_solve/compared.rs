//! The Jacobian of a local solve beside central differences of converged evaluations.

use super::super::limits::Margin;
use super::*;
use crate::loaded::evaluate;

/// Larger step of the differences that are extrapolated, in the unit box.
const COARSE: f64 = 2e-3;
/// Residuals below this are of margins far from their limits, which have no derivative.
const NEAR: f64 = -0.79;
/// Columns smaller than this are compared with it.
const LEAST: f64 = 1.0;
/// Differences of the slopes at both sides, over the size of a column, that are a kink.
const BEND: f64 = 0.1;

/// Residuals of a limb at a point, converged.
fn converged(problem: &Problem<'_>, point: &[f64], near: &At) -> Option<Vec<Residual>> {
    let mut sizes = problem.space.sizes(&point[..problem.sizes]);
    sizes.modules.iter_mut().zip(&near.limb.sizes.modules).for_each(|(own, near)| own.spacers = near.spacers);
    let limb = evaluate_at(problem.task, problem.space, &sizes, &problem.shares(point), problem.by, &near.limb)?;
    let at = At { point: point.to_vec(), limb };
    Some(problem.with_size(&at, point)?.residuals)
}

/// Columns of the Jacobian beside extrapolated central differences.
#[derive(Default)]
pub(crate) struct Compared {
    /// Error of each column in its smooth rows, over its size or one.
    pub(crate) columns: Vec<f64>,
    /// Smooth rows of all columns, and the margins of the others.
    pub(crate) smooth: usize,
    pub(crate) kinks: Vec<Margin>,
    /// Columns whose limbs beside do not all stand.
    pub(crate) fallen: usize,
}

fn try_all<T, const N: usize>(all: [Option<T>; N]) -> Option<[T; N]> {
    all.into_iter().collect::<Option<Vec<T>>>()?.try_into().ok()
}

/// Compares the Jacobian some steps down from the first guess.
pub(crate) fn compare(task: &LoadedTask, space: &LimbSpace, steps: usize, all: &mut Compared) {
    let by = Judgement { reserve: 0.05, moves: true, ..Judgement::default() };
    let guess = space.first_guess();
    let near = evaluate(task, space, &space.sizes(&guess), &by).expect("the first guess stands");
    let variables = space.variables();
    let idle: Vec<bool> = variables.iter().map(|variable| variable.name == HOME).collect();
    let sizes = variables.len();
    let (minimum, _) = local(task, space, &guess, &near, &by, steps).expect("a limb");
    let mut problem = Problem { task, space, by: &by, evaluations: 0, near: &near, warm: None, sizes, idle };
    let at = problem.evaluate(&minimum.point).expect("the limb stands");
    let jacobian = problem.jacobian(&at).expect("derivatives");
    let here = converged(&problem, &at.point, &at).expect("the limb stands");
    let rows: Vec<usize> = (0..here.len()).filter(|row| here[*row].value > NEAR).collect();
    for axis in (0..at.point.len()).filter(|axis| !problem.idle.get(*axis).copied().unwrap_or(false)) {
        let side = |by: f64| {
            let mut point = at.point.clone();
            point[axis] += by;
            let there = converged(&problem, &point, &at)?;
            Some(DVector::from_fn(here.len(), |row, _| (there[row].value - here[row].value) / by))
        };
        let steps = [COARSE, -COARSE, 0.5 * COARSE, -0.5 * COARSE];
        let Some([right, left, near_right, near_left]) = try_all(steps.map(side)) else {
            all.fallen += 1;
            continue;
        };
        let (coarse, fine) = ((&right + &left) * 0.5, (near_right + near_left) * 0.5);
        let slope = (&fine * 4.0 - &coarse) / 3.0;
        let size = rows.iter().map(|row| slope[*row].powi(2)).sum::<f64>().sqrt().max(LEAST);
        let is_smooth = |row: usize| {
            let bend = (right[row] - left[row]).abs();
            !here[row].is_stepped() && bend <= BEND * size && (fine[row] - slope[row]).abs() <= 1e-4 * size
        };
        let (smooth, kinks): (Vec<usize>, Vec<usize>) = rows.iter().partition(|row| is_smooth(**row));
        all.columns
            .push(smooth.iter().map(|row| (jacobian[(*row, axis)] - slope[*row]).powi(2)).sum::<f64>().sqrt() / size);
        all.smooth += smooth.len();
        all.kinks.extend(kinks.iter().map(|row| here[*row].lack().margin));
    }
}
