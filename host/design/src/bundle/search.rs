//! Bounded least squares from the middle of the box and from points by seed.
//!
//! A local solve that converges needs some ten steps; one that has not after three times as many costs less to begin anew than to wait for.
//! The best goes on to its end.

use super::answer::{Answer, answer};
use super::forces::Forces;
use super::problem::ForceProblem;
use softlimb_limb::payload::PayloadError;
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::{StoppingCriteria, minimise};
use softlimb_numerics::multi_start::{MultiStart, multi_start};

/// Objectives up to this count as zero.
pub(super) const ZERO: f64 = 1e-20;
/// Most evaluations of a local solve that is not known to be the best, that of the start included.
const EVALUATIONS: usize = 34;
/// Objectives within this share are the same.
const SAME: f64 = 1e-9;

/// How far a search goes.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Seed of the starts but the first, which is the middle of the box.
    pub seed: u64,
    /// Most starts.
    pub starts: usize,
    /// Local solves that must agree on the least objective, where it is not zero.
    pub agreeing: usize,
    /// Evaluations and Jacobians after which no local solve begins; the one under way, and the best, go on to their end.
    pub evaluations: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { seed: 1, starts: 20, agreeing: 2, evaluations: 100 }
    }
}

/// Solves eq. (18).
///
/// # Errors
/// [`PayloadError::Solver`] where no place has forces.
pub fn search(problem: &ForceProblem, effort: &Budget) -> Result<Answer, PayloadError> {
    let mut forces = Forces::new(problem);
    let width = forces.layout.width;
    let mut random = Random::new(effort.seed, 0);
    let criteria =
        StoppingCriteria { zero: ZERO, relative: 1e-13, evaluations: EVALUATIONS, ..StoppingCriteria::default() };
    let settings = MultiStart { starts: effort.starts, agreeing: effort.agreeing, same: SAME, criteria };
    let spent = |forces: &Forces| forces.evaluations + forces.jacobians >= effort.evaluations;
    let start = |_: &mut Forces, index: usize| Some(if index == 0 { vec![0.5; width] } else { random.point(width) });
    let (mut best, solves) = multi_start(&mut forces, settings, spent, start, |_, minimum| minimum)
        .ok_or_else(|| PayloadError::Solver("no place of the box has forces".into()))?;
    if best.objective > ZERO {
        let to_its_end = StoppingCriteria { evaluations: 10 * EVALUATIONS, ..criteria };
        let further = minimise(&mut forces, &best.point, to_its_end).filter(|end| end.objective < best.objective);
        best = further.unwrap_or(best);
    }
    answer(&mut forces, &best.point, (solves.starts, solves.agreeing))
}
