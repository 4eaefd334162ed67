//! Bounded Gauss-Newton from the middle of the box and from places by seed.
//!
//! A descent that is on its way needs some ten steps; one that still is not there after three times as many costs less to begin anew than to
//! wait for. The best goes on to its end.

use super::answer::{Answer, answer};
use super::forces::Forces;
use super::problem::ForceProblem;
use softlimb_limb::payload::PayloadError;
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::{Descent, Stop, minimise};

/// Objectives up to this count as zero.
pub(super) const ZERO: f64 = 1e-20;
/// Most steps of a descent that is not known to be the best.
const STEPS: usize = 33;
/// Objectives within this share are the same.
const SAME: f64 = 1e-9;

/// How far a search goes.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seed of the starts but the first, which is the middle of the box.
    pub seed: u64,
    /// Most descents.
    pub starts: usize,
    /// Descents that must agree on the least objective, where it is not zero.
    pub agreeing: usize,
    /// Evaluations and Jacobians after which no descent begins; the one under way, and the best, go on to their end.
    pub evaluations: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 1, starts: 20, agreeing: 2, evaluations: 100 }
    }
}

/// Solves eq. (18).
///
/// # Errors
/// [`PayloadError::Solver`] where no place has forces.
pub fn search(problem: &ForceProblem, effort: &Effort) -> Result<Answer, PayloadError> {
    let mut forces = Forces::new(problem);
    let width = forces.layout.width;
    let mut random = Random::new(effort.seed, 0);
    let stop = Stop { zero: ZERO, relative: 1e-13, steps: STEPS };
    let mut best: Option<Descent<_>> = None;
    let (mut made, mut agreeing) = (0, 0);
    while made < effort.starts && (made == 0 || forces.evaluations + forces.jacobians < effort.evaluations) {
        let start = if made == 0 { vec![0.5; width] } else { random.place(width) };
        made += 1;
        let Some(found) = minimise(&mut forces, &start, stop) else { continue };
        let least = best.as_ref().map_or(f64::INFINITY, |best| best.objective);
        if (found.objective - least).abs() <= SAME * least {
            agreeing += 1;
        } else if found.objective < least {
            agreeing = 1;
        }
        if found.objective < least {
            best = Some(found);
        }
        let reached = best.as_ref().is_some_and(|best| best.objective <= ZERO);
        if reached || agreeing >= effort.agreeing {
            break;
        }
    }
    let mut best = best.ok_or_else(|| PayloadError::Solver("no place of the box has forces".into()))?;
    if best.objective > ZERO {
        let to_its_end = Stop { steps: 10 * STEPS, ..stop };
        let further = minimise(&mut forces, &best.place, to_its_end).filter(|end| end.objective < best.objective);
        best = further.unwrap_or(best);
    }
    answer(&mut forces, &best.place, (made, agreeing))
}
