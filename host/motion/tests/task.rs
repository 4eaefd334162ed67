//! Tasks in space: obstacles, directions, regions, marker series, times, and tasks that cannot be done.

mod common;
mod hard_cases;
mod keys;
mod kinematics;
mod loaded;
mod obstacles;
mod steering;
mod swing;
mod tilt;
mod times;
