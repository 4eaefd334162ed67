//! The section model against thick-wall equations, limits, symmetries and its own meshes.

mod bending;
mod calibrate;
mod cases;
mod convergence;
mod limits;
mod misuse;
mod stiffness;
mod straight;
mod sweep;
mod two_windings;
