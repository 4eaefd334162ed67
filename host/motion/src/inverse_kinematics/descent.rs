//! Bounded, damped Gauss-Newton.
//!
//! Any decrease is accepted, and a step is cut off at the bounds, unlike in the bounded solver of `softlimb-numerics`. The last digits of
//! plans, and with them those of logs, depend on these rules.

use nalgebra::{DMatrix, DVector};

use super::ARRIVED_M;
use super::problem::{Problem, WEIGHTS};

const ITERATIONS: usize = 200;

/// Goes down from a start in the unit box until the residuals vanish or no step helps; again with a larger weight where direction or
/// clearance are then missed.
pub(super) fn descend(problem: &Problem<'_, '_>, start: Vec<f64>) -> Vec<f64> {
    let start: Vec<f64> = start.into_iter().map(|share| share.clamp(0.0, 1.0)).collect();
    let [first, last] = WEIGHTS;
    let shares = descend_with(problem, start, first);
    if problem.reach(&shares).allowed() { shares } else { descend_with(problem, shares, last) }
}

fn descend_with(problem: &Problem<'_, '_>, mut shares: Vec<f64>, weight: f64) -> Vec<f64> {
    let Some(mut here) = problem.linear(&shares, weight) else { return shares };
    let mut damping = 1e-3;
    let mut small_steps = 0;
    for _ in 0..ITERATIONS {
        let miss = here.residual.norm();
        if miss <= ARRIVED_M || damping > 1e12 || small_steps > 5 {
            break;
        }
        let Some(step) = step(&here.jacobian, &here.residual, &shares, damping) else { break };
        let next: Vec<f64> = shares.iter().zip(step.iter()).map(|(s, d)| (s + d).clamp(0.0, 1.0)).collect();
        let better = problem.linear(&next, weight).filter(|there| there.residual.norm() < miss);
        match better {
            Some(there) => {
                let gain = miss - there.residual.norm();
                small_steps = if gain < 1e-7 * miss { small_steps + 1 } else { 0 };
                (shares, here) = (next, there);
                damping = (damping * 0.2).max(1e-15);
            }
            None => damping *= 10.0,
        }
    }
    shares
}

/// The damped step; a module at an end of its range that is pulled outwards stays there.
fn step(jacobian: &DMatrix<f64>, residual: &DVector<f64>, shares: &[f64], damping: f64) -> Option<DVector<f64>> {
    let pull = -(jacobian.transpose() * residual);
    let free = |i: usize| !((shares[i] <= 0.0 && pull[i] < 0.0) || (shares[i] >= 1.0 && pull[i] > 0.0));
    let mut normal: DMatrix<f64> = jacobian.transpose() * jacobian;
    let scale = normal.diagonal().max().max(f64::MIN_POSITIVE);
    for i in 0..shares.len() {
        normal[(i, i)] += damping * scale;
        if !free(i) {
            normal.row_mut(i).fill(0.0);
            normal.column_mut(i).fill(0.0);
            normal[(i, i)] = 1.0;
        }
    }
    let right = DVector::from_fn(shares.len(), |i, _| if free(i) { pull[i] } else { 0.0 });
    normal.cholesky().map(|factors| factors.solve(&right))
}
