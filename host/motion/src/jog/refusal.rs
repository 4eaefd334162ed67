//! Reasons for which an order is refused.

use std::fmt;

use crate::space::Hindrance;
use crate::weight::PoseError;
use softlimb_scene::Scene;

/// Why an order is refused. The limb stays where it is.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// A drive is at the highest pressure that it may have.
    Highest(String),
    /// A drive is without pressure.
    AtRest(String),
    /// No drive moves the tip this way from here.
    NoWay,
    /// The tip cannot get there.
    OutOfReach,
    /// An obstacle is too near there.
    Obstacle(String),
    /// The held object would tilt by this, rad.
    Tilt(f64),
    /// The limb does not stand there under its load.
    Falls(String),
    /// Neither valves nor supply can move it.
    NoSupply,
    /// A step is under way and another one waits.
    Waits,
    /// The gripper closes or opens.
    GripperMoves,
    /// The task runs, or is held on its way.
    TaskRuns,
    /// The task begins at rest.
    NotAtRest,
}

impl Refusal {
    /// The refusal of a move that something blocks.
    pub(super) fn of(scene: &Scene, by: Hindrance) -> Self {
        match by {
            Hindrance::Obstacle(found) => Self::Obstacle(scene.obstacles()[found.obstacle].name.value.clone()),
            Hindrance::Tilt(tilt_rad) => Self::Tilt(tilt_rad),
            Hindrance::NoShape => Self::Falls("has no shape".to_owned()),
        }
    }

    /// The refusal of a pose in which the limb is unstable; it names the module.
    pub(super) fn falls(scene: &Scene, cause: PoseError) -> Self {
        Self::Falls(match cause {
            PoseError::NoEquilibrium => "has an actuator without equilibrium".to_owned(),
            PoseError::EquilibriumError(_) => "loses its stability".to_owned(),
            PoseError::Buckles { module, .. } => format!("buckles in `{}`", scene.modules()[module].name.value),
        })
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Highest(drive) => write!(f, "`{drive}` is at its highest pressure"),
            Self::AtRest(drive) => write!(f, "`{drive}` has no pressure left"),
            Self::NoWay => f.write_str("no module moves the tip this way from here"),
            Self::OutOfReach => f.write_str("out of reach"),
            Self::Obstacle(name) => write!(f, "obstacle `{name}` is too near"),
            Self::Tilt(tilt_rad) => write!(f, "the held object would tilt by {:.1} deg", tilt_rad.to_degrees()),
            Self::Falls(how) => write!(f, "the limb {how} there"),
            Self::NoSupply => f.write_str("the supply does not suffice"),
            Self::Waits => f.write_str("one step waits already"),
            Self::GripperMoves => f.write_str("the gripper moves"),
            Self::TaskRuns => f.write_str("the task is under way: it runs to its end, or is vented"),
            Self::NotAtRest => f.write_str("the task begins at rest with an open gripper: vent first"),
        }
    }
}
