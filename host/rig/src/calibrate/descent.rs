//! Least squares without bounds: Gauss-Newton with Marquardt's damping, by singular values.
//!
//! The bounded solver of `softlimb-numerics` works on the normal equations, whose condition is the square of the Jacobian's. Unknowns that
//! the data confuse need the whole condition, because the judgement of the estimate names them.

use nalgebra::{DMatrix, DVector, Dyn, SVD};

const STEPS: usize = 100;
/// Largest number of iterations of a singular value decomposition, which usually takes a few per value.
const SVD_STEPS: usize = 10_000;
const LEAST_DAMPING: f64 = 1e-14;
const MOST_DAMPING: f64 = 1e12;

/// Residuals and their Jacobian at one point.
pub(super) struct Local {
    pub(super) residuals: DVector<f64>,
    pub(super) jacobian: DMatrix<f64>,
}

/// Result of a local solve.
pub(super) struct End {
    pub(super) place: DVector<f64>,
    pub(super) local: Local,
    /// Whether the last undamped step is small against the uncertainty of the answer, or against the answer.
    pub(super) settled: bool,
    pub(super) steps: usize,
}

/// Goes down from a place. Variables are scaled: steps of the order of one are large.
///
/// # Errors
/// That of the start; elsewhere a place without an answer only shortens the step.
pub(super) fn descend<E>(start: DVector<f64>, mut at: impl FnMut(&DVector<f64>) -> Result<Local, E>) -> Result<End, E> {
    let mut local = at(&start)?;
    let (mut place, mut damping, mut steps) = (start, 1e-3, 0);
    loop {
        let objective = local.residuals.norm_squared();
        let step = damped_step(&local, damping);
        let next = &place + &step;
        let predicted = objective - (&local.residuals + &local.jacobian * &step).norm_squared();
        if objective == 0.0 || steps == STEPS || damping > MOST_DAMPING {
            break;
        }
        steps += 1;
        let reached =
            at(&next).ok().filter(|there| there.residuals.iter().chain(&there.jacobian).all(|x| x.is_finite()));
        let Some(there) = reached.filter(|there| there.residuals.norm_squared() < objective) else {
            // Rounding alone keeps a step that predicts no reduction from going down.
            if predicted <= 1e-15 * objective {
                break;
            }
            damping = (damping * 8.0).max(1e-9);
            continue;
        };
        let gain = (objective - there.residuals.norm_squared()) / predicted;
        damping = if gain > 0.5 { (damping * 0.05).max(LEAST_DAMPING) } else { damping * 2.0 };
        let still = step.norm() <= 1e-15 * place.norm();
        (place, local) = (next, there);
        if still {
            break;
        }
    }
    let settled = is_settled(&place, &local);
    Ok(End { place, local, settled, steps })
}

/// The step of Levenberg and Marquardt: `min |r + J s|^2 + d |D s|^2`, `D` the lengths of the columns.
fn damped_step(local: &Local, damping: f64) -> DVector<f64> {
    let (rows, columns) = local.jacobian.shape();
    let longest = local.jacobian.column_iter().map(|column| column.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let mut system = local.jacobian.clone().resize_vertically(rows + columns, 0.0);
    for (index, column) in local.jacobian.column_iter().enumerate() {
        system[(rows + index, index)] = damping.sqrt() * column.norm().max(1e-12 * longest);
    }
    let right = (-&local.residuals).resize_vertically(rows + columns, 0.0);
    svd(system).and_then(|svd| svd.solve(&right, 0.0).ok()).unwrap_or_else(|| DVector::zeros(columns))
}

/// Singular value decomposition with both sets of vectors; `None` if it does not converge, as for columns that underflow.
pub(super) fn svd(matrix: DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    SVD::try_new(matrix, true, true, 5.0 * f64::EPSILON, SVD_STEPS)
}

fn is_settled(place: &DVector<f64>, local: &Local) -> bool {
    let (rows, columns) = local.jacobian.shape();
    let step = damped_step(local, 0.0);
    let moved = (&local.jacobian * &step).norm_squared();
    let variance = local.residuals.norm_squared() / rows.saturating_sub(columns).max(1) as f64;
    let small = step.iter().zip(place).all(|(step, value)| step.abs() <= 1e-7 * value.abs().max(1e-3));
    moved <= 1e-6 * variance || small
}
