//! What a limb shall do under load, as plain data.

use crate::synthesis::{Aim, Direction, Obstacle};

use super::limits::StandingLimits;

/// A body that the tip has grasped upright, and that turns with it: a bottle held by its neck. Its mass is a load at the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriedBody {
    /// Radius about its vertical axis, m; > 0.
    pub radius_m: f64,
    /// How far it reaches above the tip, m; >= 0.
    pub above_m: f64,
    /// How far it reaches below the tip, m; >= 0.
    pub below_m: f64,
    /// Largest tilt of its axis, rad; > 0.
    pub tilt_max_rad: f64,
}

/// A pose: the tip reaches a place under one load, and holds it under another.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedPose {
    /// Name of the phase.
    pub name: String,
    /// Where the tip shall be.
    pub aim: Aim,
    /// Where the end effector shall point, if that matters.
    pub direction: Option<Direction>,
    /// Mass at the tip until the pose is reached, kg; >= 0.
    pub move_kg: f64,
    /// Mass at the tip from then on, kg; >= 0.
    pub hold_kg: f64,
    /// The body that is carried on the way to the pose.
    pub carried: Option<CarriedBody>,
}

impl LoadedPose {
    /// The larger of its masses, kg.
    pub fn payload_kg(&self) -> f64 {
        self.move_kg.max(self.hold_kg)
    }
}

/// What a limb shall do. Lengths in m, in one fixed frame whose third axis points up.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedTask {
    /// Length of the connector behind every module, m; >= 0.
    pub connector_m: f64,
    /// Mass of a connector, kg; >= 0.
    pub connector_kg: f64,
    /// Length and radius of the end effector, m; >= 0.
    pub tool_m: [f64; 2],
    /// Its mass, kg; >= 0.
    pub tool_kg: f64,
    /// The poses in their order; at least one.
    pub poses: Vec<LoadedPose>,
    /// What the limb and the carried body keep clear of.
    pub obstacles: Vec<Obstacle>,
    /// Whether the moves keep clear too, along straight lines in the pressures.
    pub moves: bool,
    /// Largest mass of the limb without payload, kg; `None` for any.
    pub mass_max_kg: Option<f64>,
    /// Margins that every pose keeps.
    pub limits: StandingLimits,
}
