//! The true limb of a simulation: tubes with memory between rigid plates.
//!
//! The planner has a limb of its own: exact rods, analytic walls, no memory. This crate shares no equation with it, and the compiler keeps
//! the two apart: it depends on no crate of the host that plans, and nothing that plans depends on it. Tubes come in as data
//! ([`Law`], [`Curve`]), fitted to finite elements of their section by the caller.
//!
//! `docs/explanation/body.md` has the equations, the sources of the parameters, and the effects that are left out.

mod beam;
mod body;
mod contact;
mod curve;
mod law;
mod memory;
mod motion;
mod specimen;
mod tridiagonal;
mod tube;

pub use body::{Bay, Body, Fallen, Mass, Plate, TubeStrain};
pub use contact::{Ball, Contact, Hanging, Solid};
pub use curve::Curve;
pub use law::{Law, Main, Potential, Stiffness, Term};
pub use memory::{Effects, Memory, MemoryParameters};
pub use motion::Moving;
pub use specimen::{Assembly, Tolerance};
pub use tube::Tube;
