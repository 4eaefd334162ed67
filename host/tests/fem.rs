//! Finite element decks: meshes, threads, the text of a deck, and how runs of CalculiX are judged.

#[path = "fem/deck.rs"]
mod deck;
#[path = "fem/mesh.rs"]
mod mesh;
#[path = "fem/sample.rs"]
mod sample;
