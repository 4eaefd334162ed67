//! Tasks in space: obstacles, directions, regions, marker series, times, and tasks that cannot be done.

#[path = "task/common.rs"]
mod common;
#[path = "task/hard_cases.rs"]
mod hard_cases;
#[path = "task/keys.rs"]
mod keys;
#[path = "task/kinematics.rs"]
mod kinematics;
#[path = "task/obstacles.rs"]
mod obstacles;
#[path = "task/times.rs"]
mod times;
