//! Tests of motion planning, one module a subject.

mod jog;
mod motion_plan;
#[path = "../../../tests/support/samples.rs"]
mod samples;
mod tables;
mod task;
mod valves;
