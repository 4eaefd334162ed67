//! What takes room in a run: the limb as a solid, what it carries, and what it keeps clear of.

use serde::{Deserialize, Serialize};

/// A solid that the limb keeps clear of, or a box that its tip enters, as it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolidInfo {
    /// Name in the scene file.
    pub name: String,
    /// True for a box that the tip enters.
    pub region: bool,
    /// Lines on its surface, m.
    pub lines_m: Vec<Vec<[f64; 3]>>,
    /// Its shape; `None` in logs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<SolidShape>,
}

/// A shape, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidShape {
    /// A ball.
    Sphere {
        /// Its center.
        center_m: [f64; 3],
        /// Its radius; > 0.
        radius_m: f64,
    },
    /// All points within a radius of a line.
    Capsule {
        /// One end of the line.
        from_m: [f64; 3],
        /// The other end.
        to_m: [f64; 3],
        /// The radius; > 0.
        radius_m: f64,
    },
    /// A box.
    Box {
        /// Its center.
        center_m: [f64; 3],
        /// From the center to the middle of three faces that share a corner.
        half_axes_m: [[f64; 3]; 3],
    },
}

/// An object that the tip carries for a time, upright.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CarriedInfo {
    /// Name in the scene file.
    pub name: String,
    /// Radius about its vertical axis, m.
    pub radius_m: f64,
    /// How far it reaches above the tip, m.
    pub above_m: f64,
    /// How far it reaches below the tip, m.
    pub below_m: f64,
    /// Where the plan has the tip that takes it, m; `None` in logs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_m: Option<[f64; 3]>,
    /// The gripper takes it, s after the start of the run.
    pub from_s: f64,
    /// The gripper lets it go, s; `None` where it is carried to the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
}

/// The observed limb as a solid, at one instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Time, s after the start of the run.
    pub time_s: f64,
    /// The center line from base to tip, m. Where the radius jumps there are two points at one place.
    pub line_m: Vec<[f64; 3]>,
    /// Radius about each point, m.
    pub radius_m: Vec<f64>,
    /// Distance of the surfaces of limb and carried object from the nearest obstacle, m, and its name; negative where they overlap. `None`
    /// without obstacles.
    pub nearest: Option<(f64, String)>,
    /// Tip that the same actuators have at the same pressures without weight, m; `None` where the limb has no weight, or where the setpoints
    /// compensate it.
    pub tip_unloaded_m: Option<[f64; 3]>,
}
