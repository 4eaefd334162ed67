//! A whole limb from what its tip shall do: sizes, mount angles and pressures for way-points among obstacles, and, where it is asked for,
//! the motions of the modules and their order.
//!
//! The search is kinematic. What a section can do between rest and the highest pressure it may be given is interpolated once from the model
//! (`response.rs`, `table.rs`); after that a limb is a chain of screws whose points have closed derivatives by every variable (`arc.rs`,
//! `chain.rs`), and squared errors of the tip and squared penetrations are bounded least squares (`objective.rs`, `descent.rs`), started
//! again where they end badly (`search.rs`). What is found is settled and confirmed with the model itself (`realise.rs`, `confirm.rs`).
//! `docs/explanation/limb-synthesis.md` has the equations and the figures.

mod aim;
mod arc;
mod candidate;
mod chain;
mod choice;
mod confirm;
pub mod kinds;
mod layout;
mod local_solve;
mod made;
mod moves;
mod objective;
mod order;
mod points;
mod prune;
mod realise;
mod response;
mod rows;
mod search;
mod table;
mod task;
mod variant;

pub use candidate::{CLEAR_M, Candidate, Figures, ModuleDesign, ModuleMotion, REACHED_M, Shortfall, WayPointAnswer};
pub use choice::{Choice, Choosing, Outcome, Searched, choose};
pub use order::{Budget, Evaluator, design};
pub use task::{
    Aim, Direction, MOST_MODULES, MOST_PARTS, MOST_WAY_POINTS, Obstacle, Space, Task, TaskError, Total, WayPoint,
};
