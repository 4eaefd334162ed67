//! Solids and the clearance of a limb's body from them, against closed forms and dense sampling.

mod closed_forms;
mod common;
mod sampling;
mod shapes;
