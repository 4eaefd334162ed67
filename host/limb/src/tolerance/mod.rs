//! What fabrication tolerances do to the tip: every actuator of a limb has a wall, a fiber angle and a modulus of its own, while the
//! pressures stay those of the nominal limb.
//!
//! Two routes to the same figures. [`linear`] takes exact derivatives of the model through bundle and limb; [`sample`] makes limbs by seed
//! and asks the model for each. [`Statistics`] puts them side by side. Unlike actuators in a bundle also bend it: it takes the shape of
//! least energy of its tubes, each a spring at its own free state, as in [`crate::statics`]. `docs/explanation/tolerance.md` has the conventions.

mod input;
mod linear;
mod made;
mod parallel;
mod picture;
mod sample;
mod section;
mod shape;
mod statistics;
mod study;

pub use input::{Kind, Varied};
pub use linear::{Linear, linear};
pub use picture::picture;
pub use sample::{Deviation, Sample, sample};
pub use softlimb_numerics::statistics::Estimate;
pub use statistics::{PhaseStatistics, Share, Statistics};
pub use study::{Pose, Settings, Study, ToleranceError};
