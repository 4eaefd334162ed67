//! Solids and the clearance of a limb's body from them, against closed forms and dense sampling.

#[path = "obstacle/closed_forms.rs"]
mod closed_forms;
#[path = "obstacle/common.rs"]
mod common;
#[path = "obstacle/sampling.rs"]
mod sampling;
#[path = "obstacle/shapes.rs"]
mod shapes;
