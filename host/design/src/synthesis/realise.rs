//! From a minimum of the search to a limb that the model confirms.
//!
//! The sections found are taken as they are; their response is interpolated anew, now to some 1e-9, and lengths, mount angles and
//! deformations go down once more. Where the body comes too near to an obstacle between the points of the objective, the nearest point
//! joins them and the local solve goes on. Then the model is asked (`confirm.rs`).

use super::candidate::CLEAR_M;
use super::chain::MOUNT;
use super::layout::Layout;
use super::local_solve::{criteria, solve};
use super::moves::{Move, Nearest, spot};
use super::objective::{Objective, Pose, Spot};
use super::search::LocalMinimum;
use super::table::Table;
use super::task::{Space, Task, TaskError};

/// Objective that no further round brings down to nothing, mm2.
const HOPELESS_MM2: f64 = 1.0;
/// Rounds of local solves with more body points.
const ROUNDS: usize = 6;

impl Space {
    /// The same with the section at a place of its unit box, and nothing left to choose about it.
    pub(super) fn at_section(&self, [x, y, z]: [f64; 3]) -> Self {
        let mut space = self.clone();
        let bounds = &mut space.segment.bounds;
        let at =
            |[low, high]: [f64; 2], share: f64| if share == 1.0 { [high; 2] } else { [low + share * (high - low); 2] };
        bounds.sizes_m = [at(bounds.sizes_m[0], x), at(bounds.sizes_m[1], y)];
        bounds.angle_rad = at(bounds.angle_rad, z);
        space
    }
}

/// A limb whose sections are given.
pub(super) struct Exact<'a> {
    pub(super) objective: Objective<'a>,
    pub(super) place: Vec<f64>,
}

/// The sections of a minimum.
pub(super) fn sections(spaces: &[&Space], layout: &Layout, place: &[f64]) -> Vec<Space> {
    spaces.iter().enumerate().map(|(module, space)| space.at_section(layout.section(place, module))).collect()
}

/// The tables of given sections.
pub(super) fn fine_tables(sections: &[Space]) -> Result<Vec<Table>, TaskError> {
    sections.iter().map(Table::fine).collect()
}

impl<'a> Exact<'a> {
    /// The place of a minimum among the variables that are left.
    pub(super) fn new(
        task: &'a Task,
        sections: &[Space],
        tables: &'a [Table],
        from: (&Layout, &LocalMinimum),
        on_a_move: usize,
    ) -> Self {
        let layout = Layout::new(&sections.iter().collect::<Vec<_>>(), task.way_points.len());
        let (old, minimum) = from;
        let mut place = vec![0.5; layout.width()];
        for module in 0..sections.len() {
            for slot in 3..=MOUNT {
                if let (Some(to), Some(from)) = (layout.common[module][slot], old.common[module][slot]) {
                    place[to] = minimum.place[from];
                }
            }
            for way_point in 0..task.way_points.len() {
                place[layout.share(way_point, module)] = minimum.place[old.share(way_point, module)];
            }
        }
        let mut objective = Objective::new(task, layout, tables.iter().collect(), on_a_move);
        objective.spare_m = CLEAR_M;
        Self { objective, place }
    }

    /// Goes down, and again with the body points that turn out to be missing.
    pub(super) fn settle(&mut self) -> usize {
        let all: Vec<usize> = (0..self.place.len()).collect();
        let criteria = criteria(1e-16, 1e-9, 200);
        let mut spent = 0;
        for _ in 0..ROUNDS {
            let (value, evaluations) = solve(&self.objective, &mut self.place, &all, criteria);
            spent += evaluations;
            if value > HOPELESS_MM2 || !self.add_missing_points() {
                break;
            }
        }
        spent
    }

    /// Adds the nearest points that are too near; false when there are none.
    fn add_missing_points(&mut self) -> bool {
        let (objective, task) = (&self.objective, self.objective.task);
        let curves = objective.curves(&self.place);
        let mut poses: Vec<Pose> = Vec::new();
        let mut spots: Vec<Spot> = Vec::new();
        for to in 0..task.way_points.len() {
            let from = to.checked_sub(1);
            let line = Move { objective, place: &self.place, curves: &curves, from, to };
            for (index, obstacle) in task.obstacles.iter().enumerate() {
                let keeps = obstacle.clearance_m + 0.5 * CLEAR_M;
                let Some(Nearest { clearance, share }) = line.nearest(&obstacle.shape, keeps) else { continue };
                let known = objective.poses.iter().position(|pose| share == 1.0 && pose.to == to && pose.share == 1.0);
                let pose = known.unwrap_or_else(|| {
                    poses.push(Pose { from, to, share });
                    objective.poses.len() + poses.len() - 1
                });
                let (module, along) = spot(objective, &clearance);
                spots.push(Spot { pose, obstacle: index, module, along });
            }
        }
        let more = !spots.is_empty();
        self.objective.poses.extend(poses);
        self.objective.spots.extend(spots);
        more
    }
}
