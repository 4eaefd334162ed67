//! From the phases of a scene to the setpoints that are streamed: targets, way-points, timing, and what the device is told.

mod air;
mod clear;
mod follow;
mod goal;
mod inverse_kinematics;
pub mod inverse_table;
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

pub use air::{dead_volume_m3, line_conductance_m3_per_s_pa};
pub use clear::Nearness;
pub use inverse_kinematics::{Obstruction, Reach, TipGoal, TipTask, solutions, solve, solve_tip};
pub use inverses::{ModuleInverse, check_goals, inverses};
pub use jacobian::tip_slopes;
pub use payload::{Carried, carried, payload_kg};
pub use plan::{Plan, PlannedPhase, plan, sent};
pub use weight::{NoPose, Nominal, OnLimb, Pose, Weighed, planned_slopes};
pub use wire::{to_wire, wire_kind};
