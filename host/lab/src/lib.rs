//! The laboratory: methods compared, accuracy against cost, finite elements beside the model, and the pages of evidence they write.
//!
//! `cargo xtask lab VERB` runs it. Nothing a user runs depends on it.

pub mod accuracy;
mod arguments;
pub mod control;
pub mod design;
pub mod faults;
pub mod generated_section;
pub mod measured;
pub mod payload;
mod published;
mod statics;
mod truth;
pub mod validation;

pub use arguments::main;
