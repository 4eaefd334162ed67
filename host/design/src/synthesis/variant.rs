//! The task with something asked more of it, so that limbs are found which are better in one respect.

use super::candidate::Candidate;
use super::table::Table;
use super::task::{Space, Task, TaskError};

/// Clearance that a clear limb keeps more than is required, m.
const MORE_CLEARANCE_M: f64 = 10e-3;

/// A task and what modules may be, with the tables of their responses.
pub(super) struct Variant {
    pub(super) task: Task,
    pub(super) spaces: Vec<Space>,
    pub(super) tables: Vec<Table>,
    /// What obstacles are kept farther away than asked, m.
    more_clearance_m: f64,
}

impl Variant {
    /// The task as it is; with two thirds and with a third of the pressure; with the shorter, thinner half of all sizes; with more
    /// clearance, where there are obstacles.
    pub(super) fn all(task: &Task, spaces: &[Space]) -> Result<Vec<Self>, TaskError> {
        let pressed = |share: f64| {
            let mut spaces = spaces.to_vec();
            spaces.iter_mut().for_each(|space| space.segment.pressure_max_pa *= share);
            spaces
        };
        let mut light = spaces.to_vec();
        for space in &mut light {
            let bounds = &mut space.segment.bounds;
            let [x, y] = bounds.sizes_m;
            (bounds.length_m, bounds.sizes_m) = (lower_half(bounds.length_m), [lower_half(x), lower_half(y)]);
        }
        let mut clear = task.clone();
        clear.obstacles.iter_mut().for_each(|obstacle| obstacle.clearance_m += MORE_CLEARANCE_M);
        let mut all = vec![
            Self::new(task.clone(), spaces.to_vec(), 0.0)?,
            Self::new(task.clone(), pressed(2.0 / 3.0), 0.0)?,
            Self::new(task.clone(), pressed(1.0 / 3.0), 0.0)?,
            Self::new(task.clone(), light, 0.0)?,
        ];
        if !task.obstacles.is_empty() {
            all.push(Self::new(clear, spaces.to_vec(), MORE_CLEARANCE_M)?);
        }
        Ok(all)
    }

    fn new(task: Task, spaces: Vec<Space>, more_clearance_m: f64) -> Result<Self, TaskError> {
        let tables = spaces.iter().map(Table::new).collect::<Result<_, _>>()?;
        Ok(Self { task, spaces, tables, more_clearance_m })
    }

    /// A limb found, with its figures those of the task as it was asked.
    pub(super) fn as_asked(&self, mut limb: Candidate) -> Candidate {
        if let Some(spare) = &mut limb.figures.spare_clearance_m {
            *spare += self.more_clearance_m;
        }
        limb
    }
}

fn lower_half([low, high]: [f64; 2]) -> [f64; 2] {
    [low, 0.5 * (low + high)]
}
