//! Controller against plant through the link: what the chambers and the actuators really do about setpoints.
//!
//! The reference is never the controller's: pressures that belong to deformations come from the model in f64, and pressures and
//! deformations achieved from the plant's truth. Run with `--nocapture` for the numbers.

#[path = "closed_loop/actuators.rs"]
mod actuators;
#[path = "closed_loop/air.rs"]
mod air;
#[path = "closed_loop/bench.rs"]
mod bench;
#[path = "closed_loop/deformations.rs"]
mod deformations;
#[path = "closed_loop/pressures.rs"]
mod pressures;
