//! From the phases of a scene to the setpoints that are streamed: targets, way-points, timing, and the device's tables.
//!
//! Planning returns a typed reason where the limb cannot meet a demand; `diagnostics` alone turns it into an error at the scene's line.

mod air;
mod carrier;
mod clear;
mod corrections;
mod diagnostics;
mod follow;
mod goal;
mod inverse_kinematics;
pub mod inverse_table;
mod inverses;
mod jacobian;
pub mod jog;
mod path;
mod payload;
mod plan;
mod profile;
mod route;
mod schedule;
mod sent;
mod setpoint;
mod space;
mod timing;
mod track;
mod unreachable;
mod upright;
mod valve_step;
mod weight;
mod wire;

pub use air::{AirDemand, air_demand, dead_volume_m3, line_conductance_m3_per_s_pa};
pub use clear::Nearness;
pub use corrections::moved_warnings;
pub use diagnostics::{corrected, margins, plan, sent, swings, vibrations};
pub use inverse_kinematics::{Obstruction, Reach, TipGoal, TipTask, solutions, solve, solve_tip};
pub use inverses::{ModuleInverse, check_goals, inverses};
pub use jacobian::tip_slopes;
pub use payload::{Carried, Carrying, carried, payload_kg, payload_warnings};
pub use plan::{Plan, PlannedPhase, held_share};
pub use sent::Sent;
pub use upright::Upright;
pub use valve_step::{valve_step_pa, valve_warnings};
pub use weight::{Margins, Nominal, Pose, PoseError, Swing, Vibrations, Weighed, planned_slopes};
pub use wire::{to_wire, wire_kind};
