//! From a scene to the limb it describes: solvable actuators, kinematics, and what each module can reach. And from a task to a limb:
//! [`fit`] finds geometry and pressures for given deformations, [`path`] a whole limb for way-points of its tip among obstacles, and
//! [`brief`] turns scenes into their problems and what they find into scenes.

pub mod brief;
mod curve;
pub mod fit;
mod limb;
pub mod path;

pub use curve::StateCurve;
pub use limb::{Limb, LimbModule, measure};
use limb::{base_pose, reference_max_pa};
