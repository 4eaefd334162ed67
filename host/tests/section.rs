//! The section model against thick-wall equations, limits, symmetries and its own meshes.

#[path = "section/bending.rs"]
mod bending;
#[path = "section/calibrate.rs"]
mod calibrate;
#[path = "section/cases.rs"]
mod cases;
#[path = "section/convergence.rs"]
mod convergence;
#[path = "section/limits.rs"]
mod limits;
#[path = "section/misuse.rs"]
mod misuse;
#[path = "section/stiffness.rs"]
mod stiffness;
#[path = "section/straight.rs"]
mod straight;
#[path = "section/sweep.rs"]
mod sweep;
