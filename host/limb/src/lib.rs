//! The limb of a scene: its actuators and kinematics, and everything that follows from them without a plan.
//!
//! [`Limb`] holds solvable modules. [`statics`] loads it, [`workspace`] finds the reach of its tip, [`payload`] its largest load,
//! [`tolerance`] the effect of fabrication scatter, and [`fabricate`] the sheets and molds of its actuators. [`batch`] solves
//! many actuators at once.
//!
//! This crate must not know time, the device, files or printing.

pub mod arc;
pub mod batch;
mod bend;
mod chain;
mod curve;
pub mod fabricate;
mod limb;
pub mod payload;
mod restraint;
mod series;
pub mod statics;
mod stretch;
pub mod tolerance;
mod winding_error;
pub mod workspace;

pub use bend::Bend;
pub use chain::Chain;
pub use curve::StateCurve;
pub use limb::{Drive, Limb, LimbModule, base_pose, bending_law, reference_max_pa};
pub use restraint::TWIST_SHARE_MIN;
pub use stretch::largest_stretch;
pub use winding_error::{Bent, WINDING_ERROR_RAD, winding_effect, winding_effect_up_to};
