//! From the phases of a scene to the setpoints that are streamed: targets, way-points, timing, and what the device is told.

mod configuration;
mod follow;
mod inverse_kinematics;
mod inverses;
mod plan;
mod profile;
mod wire;

pub use configuration::configuration;
pub use inverse_kinematics::{Reach, solve_tip};
pub use inverses::{ModuleInverse, check_goals, inverses};
pub use plan::{Plan, PlannedPhase, plan};
pub use wire::wire_kind;
