//! Tests of motion planning, one module a subject.

mod jog;
mod motion_plan;
mod tables;
mod task;
mod valves;
