//! Geometry and pressures from target deformations, eq. (14) of the paper: which actuators, given what pressures, do in each phase what
//! is asked of them.
//!
//! Segments with pressures of their own do not talk to each other, and given a geometry the pressure of a phase is an explicit
//! inverse. So each segment is searched alone, in its geometry alone. On one supply line the pressures are common, and all is searched
//! together, by differences; other derivatives are exact.
//!
//! `docs/explanation/actuator-design.md` has the equations and the format of problems and answers.

mod actuator;
mod along;
mod answer;
mod edge;
mod effort;
pub(crate) mod file;
mod grid;
mod hops;
pub mod kinds;
mod objective;
mod problem;
mod reach;
mod refined;
mod ridge;
mod search;
mod section;
mod settle;
mod shared;
mod slopes;

pub(super) use actuator::Candidate;
pub use actuator::Counts;
pub use answer::{
    Answer, BendAnswer, Design, DesignError, PhaseAnswer, SegmentAnswer, Terms, search, search_watched, solve,
    solve_watched,
};
pub use objective::Objective;
pub use problem::{Bounds, Geometry, GeometryBounds, Goal, Problem, Segment, Sizes, Winding};
pub use search::{Budget, Progress, SolveCounts};
pub(super) use section::{Section as Elements, errs};
pub use softlimb_files::problem::ProblemError;
