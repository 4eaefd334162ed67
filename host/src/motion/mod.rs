//! From the phases of a scene to the setpoints that are streamed: targets, way-points, timing, and what the device is told.

mod air;
mod arc;
mod clear;
mod configuration;
mod follow;
mod goal;
mod inverse_kinematics;
mod inverses;
mod jacobian;
mod path;
mod plan;
mod profile;
mod refusal;
mod route;
mod schedule;
mod space;
mod timing;
mod why_not;
mod wire;

pub(crate) use arc::Arc;
pub use clear::Nearness;
pub use configuration::configuration;
pub use inverse_kinematics::{Obstruction, Reach, TipGoal, TipTask, solutions, solve, solve_tip};
pub use inverses::{ModuleInverse, check_goals, inverses};
pub use plan::{Plan, PlannedPhase, plan};
pub use wire::wire_kind;
