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
mod payload;
mod plan;
mod profile;
mod refusal;
mod route;
mod schedule;
mod space;
mod timing;
mod weight;
mod why_not;
mod wire;

pub(crate) use arc::Arc;
pub use clear::Nearness;
pub use configuration::configuration;
pub use inverse_kinematics::{Obstruction, Reach, TipGoal, TipTask, solutions, solve, solve_tip};
pub use inverses::{ModuleInverse, check_goals, inverses};
pub(crate) use jacobian::tip_slopes;
pub use payload::{Carried, carried, payload_kg};
pub use plan::{Plan, PlannedPhase, plan, sent, taught};
pub use weight::{NoPose, Nominal, OnLimb, Pose, Weighed};
pub use wire::wire_kind;
