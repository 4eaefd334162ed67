//! Three-dimensional finite elements: decks in the Abaqus dialect, and runs of CalculiX with them.
//!
//! An actuator or a bundle becomes a structured mesh of quadratic elements with solid caps ([`Model`]) and a deck that CalculiX and Abaqus
//! read ([`Deck`]). [`run`] starts CalculiX with it and reduces what it prints to the strains in the middle of the length and between
//! the ends ([`Point`]). What is modelled how, and how close it comes, is in `docs/explanation/solid-elements.md`.
//!
//! This room knows nothing of scenes, reads no clock and prints nothing. It is independent of the model's equations: of `fra-model` it uses
//! the parameters alone, so that it can judge them.

mod cards;
mod ccx;
mod dat;
mod deck;
mod error;
mod gauge;
mod layers;
mod mesh;
mod model;
mod options;
mod outcome;
mod parts;
mod plan;
mod run;
mod scratch;
mod table;
mod threads;
mod ties;
mod vtu;

pub use ccx::{End, Runner};
pub use deck::Deck;
pub use error::FemError;
pub use gauge::Rates;
pub use mesh::quality::Quality;
pub use mesh::{Element, Kind, Mesh, Part};
pub use model::Model;
pub use options::{FiberModel, Options, Subject, SymmetryUse};
pub use outcome::{Ends, Point, PointStatus, Run};
pub use plan::{Around, Symmetry};
pub use run::{RunProgress, run};
