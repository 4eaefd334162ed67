//! Obstacles of a limb: solids, the limb's body, and the clearance between them.
//!
//! A [`Shape`] is a convex solid with a signed distance. A [`Body`] is the centre line of a limb with a radius along it, that is every
//! ball of that radius about a point of the line. [`Body::clearance`] is the least distance of their surfaces, negative where they
//! overlap, proven to [`TOLERANCE_M`] along the whole line and not sampled.
//!
//! This room knows neither scenes nor actuators.

mod body;
mod clearance;
mod outline;
mod shape;

pub use body::{Body, Piece};
pub use clearance::{Clearance, TOLERANCE_M};
pub use shape::{Distance, Shape};
