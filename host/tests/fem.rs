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
#[path = "fem/runner.rs"]
mod runner;
