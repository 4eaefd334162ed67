//! From a scene to the limb it describes: solvable actuators, kinematics, and what each module can reach.

mod curve;
mod limb;

pub use curve::StateCurve;
pub use limb::{Limb, LimbModule, measure};
