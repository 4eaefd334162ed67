//! Finite element decks: meshes, threads, the text of a deck, and how runs of CalculiX are judged.
//!
//! Those that run CalculiX itself are in `calculix.rs`.

mod deck;
mod mesh;
pub(crate) mod sample;

// Scripts that stand for CalculiX are the system's.
#[cfg(unix)]
mod fake;
#[cfg(unix)]
mod runner;

use fra_model::{ActuatorParameters, Families, Motion};
use sample::wound;

/// Every single motion with the winding it is made for.
pub(crate) fn motions() -> [ActuatorParameters<f64>; 4] {
    [
        wound(Motion::Extension, 3.0, Families::Two),
        wound(Motion::Expansion, 80.0, Families::Two),
        wound(Motion::Bending, 3.0, Families::Two),
        wound(Motion::Twisting, 30.0, Families::One),
    ]
}
