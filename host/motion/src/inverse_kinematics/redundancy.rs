//! Where a limb can do a task in many ways, the way nearest to where it was.

use nalgebra::{DMatrix, DVector};

use super::descent::descend;
use super::distance;
use super::problem::Problem;

const ITERATIONS: usize = 40;
/// Singular values below this share of the largest are taken as zero.
const RANK: f64 = 1e-6;
/// A step shorter than this, in shares, is the end.
const STEP_MIN: f64 = 1e-5;

/// Moves a solution along the other solutions towards `home`, as far as that brings it nearer. What is no solution stays.
///
/// Each step goes along the directions that change no residual in first order and is then corrected by a descent.
pub(super) fn settle(problem: &Problem<'_, '_>, solution: Vec<f64>, home: &[f64]) -> Vec<f64> {
    let mut shares = solution;
    if !problem.reach(&shares).reached() {
        return shares;
    }
    for _ in 0..ITERATIONS {
        let towards = DVector::from_iterator(home.len(), home.iter().zip(&shares).map(|(home, here)| home - here));
        let Some(here) = problem.linear(&shares, 1.0) else { break };
        let Some(along) = along_solutions(&here.jacobian, &towards, &shares) else { break };
        if along.norm() < STEP_MIN {
            break;
        }
        let try_share = |share: f64| {
            let moved = shares.iter().zip(along.iter()).map(|(s, d)| (s + share * d).clamp(0.0, 1.0)).collect();
            let next = descend(problem, moved);
            let nearer = distance(&next, home) < distance(&shares, home) - 0.1 * STEP_MIN;
            (nearer && problem.reach(&next).reached()).then_some(next)
        };
        match [1.0, 0.3, 0.1, 0.03].into_iter().find_map(try_share) {
            Some(next) => shares = next,
            None => break,
        }
    }
    shares
}

/// The part of `towards` that changes no residual; modules at an end of their range that it would push out are held.
/// `None` where nothing is left.
fn along_solutions(jacobian: &DMatrix<f64>, towards: &DVector<f64>, shares: &[f64]) -> Option<DVector<f64>> {
    let mut held = vec![false; shares.len()];
    for _ in 0..=shares.len() {
        let mut free = jacobian.clone();
        let mut wish = towards.clone();
        for (index, _) in held.iter().enumerate().filter(|(_, held)| **held) {
            free.column_mut(index).fill(0.0);
            wish[index] = 0.0;
        }
        let svd = free.svd(false, true);
        let rows = svd.v_t?;
        let most = svd.singular_values.max();
        for (row, value) in rows.row_iter().zip(svd.singular_values.iter()) {
            if *value > RANK * most {
                let part = row.transpose().dot(&wish);
                wish -= row.transpose() * part;
            }
        }
        let leaves = |i: usize| (shares[i] <= 0.0 && wish[i] < -1e-12) || (shares[i] >= 1.0 && wish[i] > 1e-12);
        let out: Vec<usize> = (0..shares.len()).filter(|i| !held[*i] && leaves(*i)).collect();
        if out.is_empty() {
            return Some(wish);
        }
        out.into_iter().for_each(|index| held[index] = true);
    }
    None
}
