//! Solids around the limb, and motions given in space.

use crate::collision::Shape;
use crate::source::{Located, Span};

/// A solid that the limb keeps clear of.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Obstacle {
    /// Name, unique among the obstacles.
    pub name: Located<String>,
    /// The solid, in the scene's frame.
    pub shape: Shape,
    /// The header of its table.
    pub span: Span,
}

/// A box that the tip can be asked to be in.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Region {
    /// Name, unique among the regions.
    pub name: Located<String>,
    /// The box, in the scene's frame.
    pub shape: Shape,
    /// The header of its table.
    pub span: Span,
}

/// A thing that the tip carries: upright, hanging from where it is grasped.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Object {
    /// Name, unique among the objects.
    pub name: Located<String>,
    /// Radius about its vertical axis, m; > 0.
    pub radius_m: f64,
    /// Height, m; > 0.
    pub height_m: f64,
    /// Height above its bottom at which the tip holds it, m; 0 to `height_m`.
    pub grasp_m: f64,
    /// Mass, kg; >= 0.
    pub mass_kg: f64,
    /// Largest angle of its axis from the vertical since it was grasped, rad; > 0.
    pub tilt_max_rad: f64,
    /// The header of its table.
    pub span: Span,
}

/// The direction that the end effector shall have at the end of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Aim {
    /// Unit vector along the end effector's axis, from the last connector to the tip.
    pub direction: Located<[f64; 3]>,
    /// Largest angle between the axis and it, rad; > 0.
    pub tolerance_rad: f64,
}

/// Command to the gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gripper {
    /// Open.
    Open,
    /// Close.
    Close,
}

/// Position of the tip at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Time after the first marker, s.
    pub time_s: f64,
    /// Position of the tip, m.
    pub tip_m: [f64; 3],
}
