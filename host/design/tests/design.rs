//! Design from target deformations: `softlimb_design::actuators` and `softlimb design`.

mod common;
mod derivatives;
mod effort;
mod files;
mod hard_cases;
mod optima;
mod ridge;
mod wide_lines;
mod wound;
