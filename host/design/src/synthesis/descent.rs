//! Damped Gauss-Newton on the unit box, over some or all of the variables.

use nalgebra::{DMatrix, DVector};

use super::objective::{Objective, Quadratic};
use softlimb_numerics::least_squares::bounded_step;

const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e8;

/// When a descent ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// An objective that is as good as zero, mm2.
    pub(super) zero: f64,
    /// Least share of the objective that a step must gain; three that do not end the descent.
    pub(super) gain: f64,
    /// Most evaluations.
    pub(super) evaluations: usize,
}

/// Goes down from `place`, changing the variables of `free` only; answers the objective reached and the evaluations spent.
pub(super) fn descend(objective: &Objective, place: &mut Vec<f64>, free: &[usize], patience: Patience) -> (f64, usize) {
    let mut here = objective.at(place);
    let mut damping = 1e-3;
    let (mut spent, mut idle) = (1, 0);
    while spent < patience.evaluations && here.value > patience.zero && idle < 3 {
        let (gradient, normal) = restrict(&here, free);
        let inner = DVector::from_iterator(free.len(), free.iter().map(|index| place[*index]));
        let scale = normal.diagonal().max().max(f64::MIN_POSITIVE);
        let Some((step, foretold)) = bounded_step(&normal, &gradient, &inner, &mut damping, scale) else { break };
        if foretold <= 1e-14 * here.value {
            if damping <= LEAST_DAMPING {
                break;
            }
            damping = (damping * 1e-3).max(LEAST_DAMPING);
            idle += 1;
            continue;
        }
        let mut there = place.clone();
        free.iter().zip(step.iter()).for_each(|(index, step)| there[*index] = (there[*index] + step).clamp(0.0, 1.0));
        let next = objective.at(&there);
        spent += 1;
        let gained = here.value - next.value;
        let gain = gained / foretold;
        if gain.is_nan() || gain <= 1e-4 {
            damping *= if gain > -1.0 { 4.0 } else { 10.0 };
            if damping > MOST_DAMPING {
                break;
            }
            continue;
        }
        damping *= if gain > 0.75 {
            0.1
        } else if gain < 0.25 {
            3.0
        } else {
            1.0
        };
        damping = damping.clamp(LEAST_DAMPING, MOST_DAMPING);
        idle = if gained < patience.gain * here.value { idle + 1 } else { 0 };
        (*place, here) = (there, next);
    }
    (here.value, spent)
}

fn restrict(all: &Quadratic, free: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
    let gradient = DVector::from_iterator(free.len(), free.iter().map(|index| all.gradient[*index]));
    let normal = DMatrix::from_fn(free.len(), free.len(), |i, j| all.normal[(free[i], free[j])]);
    (gradient, normal)
}
