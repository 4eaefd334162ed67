//! A design whose plan has the last word: straight moves where they can be had, otherwise moves that the planner leads around.
//!
//! The search knows straight moves alone and gives way-points up for them. Where a limb that keeps them is not found, or is not planned,
//! the moves are left to the planner: limbs for the way-points alone, one seed after the other, until one can be run.

use super::loaded::LoadedDesign;
use crate::loaded::{Effort, Found, search};
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

/// A limb under load and what the planner says of it.
#[derive(Clone, Debug)]
pub struct LoadedAttempt {
    /// The limb.
    pub found: Found,
    /// Why the planner refuses it, or which margin it does not keep as the planner has it; `None` where it keeps all.
    pub refused: Option<String>,
    /// Limbs that were designed and refused, this one not counted.
    pub others: usize,
}

/// The limb under load that does a task as the planner has it, too: `refused` states why it does not. Further seeds are searched as long as
/// limbs are found and refused, six at most; where all are, the answer is the first one. `None` where no limb stands at all.
///
/// Each local solve calls `stop` first.
pub fn loaded_to_run(
    design: &LoadedDesign,
    effort: &Effort,
    stop: &(dyn Fn() -> bool + Sync),
    refused: impl Fn(&Found) -> Option<String>,
) -> Option<LoadedAttempt> {
    let (task, space) = (&design.task, &design.space);
    let limb = |more: u64| {
        let effort = Effort { seed: effort.seed.wrapping_add(more << 32), ..*effort };
        search(task, space, &space.first_guess(), &effort, stop)
    };
    let found = limb(0)?;
    let why = refused(&found);
    if !found.reached || why.is_none() {
        return Some(LoadedAttempt { found, refused: why, others: 0 });
    }
    for more in 1..LIMBS {
        match limb(more) {
            Some(other) if other.reached && !stop() => {
                if refused(&other).is_none() {
                    return Some(LoadedAttempt { found: other, refused: None, others: more as usize });
                }
            }
            _ => break,
        }
    }
    Some(LoadedAttempt { found, refused: why, others: 0 })
}
