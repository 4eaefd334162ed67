//! From a scene to the limb it describes: solvable actuators, kinematics, and what each module can reach. And from a task to a limb:
//! [`fit`] finds geometry and pressures for given deformations, [`path`] a whole limb for way-points of its tip among obstacles.

mod curve;
pub mod fit;
mod limb;
pub mod path;

pub use curve::StateCurve;
pub use limb::{Limb, LimbModule, measure};
