//! Finite element decks: meshes, threads, the text of a deck, and how runs of CalculiX are judged.
//!
//! Those that run CalculiX itself are in `calculix.rs`.

#[path = "fem/deck.rs"]
mod deck;
#[path = "fem/mesh.rs"]
mod mesh;
#[path = "fem/sample.rs"]
mod sample;

// Scripts that stand for CalculiX are the system's.
#[cfg(unix)]
#[path = "fem/command.rs"]
mod command;
#[cfg(unix)]
#[path = "fem/fake.rs"]
mod fake;
#[cfg(unix)]
#[path = "fem/files.rs"]
mod files;
#[cfg(unix)]
#[path = "fem/runner.rs"]
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
