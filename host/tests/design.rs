//! Design from target deformations: `softlimb::design::fit` and `softlimb design`.

#[path = "design/command.rs"]
mod command;
#[path = "design/common.rs"]
mod common;
#[path = "design/compare.rs"]
mod compare;
#[path = "design/derivatives.rs"]
mod derivatives;
#[path = "design/files.rs"]
mod files;
#[path = "design/hard_cases.rs"]
mod hard_cases;
#[path = "design/optima.rs"]
mod optima;
#[path = "design/ridge.rs"]
mod ridge;
