//! A design whose plan has the last word: straight moves where they can be had, otherwise moves that the planner leads around.
//!
//! The search knows straight moves alone and gives way-points up for them. Where a limb that keeps them is not found, or is not planned,
//! the moves are left to the planner: limbs for the way-points alone, one seed after the other, until one can be run.

use crate::synthesis::{Budget, Candidate, Space, Task, TaskError, design};

/// Limbs that are designed for the way-points alone before that is given up.
const LIMBS: u64 = 6;

/// A design and what the planner says of it.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// The limb.
    pub limb: Candidate,
    /// Via points of its moves; `None` where the planner refuses it or was not asked, since it does not do the task.
    pub via_points: Option<usize>,
    /// Limbs that were designed for the way-points alone and refused by the planner, this one not counted.
    pub refused: usize,
}

/// The limb that does a task as `plan` has it, which gives the number of via points on the moves of a limb, or `None` where there is no way.
///
/// Where no limb does it, the answer is that of the first search, for straight moves, with its shortfall.
///
/// # Errors
/// As [`design`].
pub fn design_to_run(
    task: &Task,
    spaces: &[Space],
    effort: &Budget,
    plan: impl Fn(&Candidate) -> Option<usize>,
) -> Result<Attempt, TaskError> {
    let limb = design(task, spaces, effort)?;
    let via_points = if limb.does_it() { plan(&limb) } else { None };
    if via_points.is_some() || task.obstacles.is_empty() {
        return Ok(Attempt { limb, via_points, refused: 0 });
    }
    let alone = Task { moves: false, ..task.clone() };
    let mut refused = 0;
    for more in 0..LIMBS {
        let other = design(&alone, spaces, &Budget { seed: effort.seed.wrapping_add(more), ..*effort })?;
        if !other.does_it() {
            // The way-points themselves cannot be had: another seed of the same search seldom helps.
            break;
        }
        match plan(&other) {
            Some(count) => return Ok(Attempt { limb: other, via_points: Some(count), refused }),
            None => refused += 1,
        }
    }
    Ok(Attempt { limb, via_points, refused })
}
