//! The limb as viewers draw it: rigid cylinders in moving frames.

use serde::{Deserialize, Serialize};

/// Name of the fixed frame of all positions: that of the scene.
pub(super) const WORLD: &str = "world";
/// Name of the frame at the start of the limb.
pub(super) const BASE: &str = "base";
/// Name of the frame at its end.
pub(super) const TIP: &str = "tip";

/// A pose in the scene's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Its position, m.
    pub position_m: [f64; 3],
    /// Its rotation: a unit quaternion, x, y, z, w.
    pub rotation: [f64; 4],
}

impl Pose {
    /// A position with the axes of the scene.
    pub(super) fn upright(position_m: [f64; 3]) -> Self {
        Self { position_m, rotation: [0.0, 0.0, 0.0, 1.0] }
    }
}

/// The limb as it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DrawnLimb {
    /// Start of the first module; its `z` axis is the limb's.
    pub base: Pose,
    /// Cylinders from the base to the tip, along the `z` axes of their frames.
    pub links: Vec<DrawnLink>,
    /// Names of the modules: each has the frame of a connector at the end of its moving part.
    pub modules: Vec<String>,
}

/// One cylinder of a drawn limb.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DrawnLink {
    /// Its length at the greatest deformation: links that are shorter overlap, and no gap opens.
    pub length_m: f64,
    /// Its radius at rest.
    pub radius_m: f64,
    /// True for a connector or a tool.
    pub rigid: bool,
}

/// Poses of a drawn limb at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Time, s after the start of the run.
    pub time_s: f64,
    /// Middle of each link.
    pub links: Vec<Pose>,
    /// End of the moving part of each module.
    pub connectors: Vec<Pose>,
    /// End of the limb.
    pub tip: Pose,
}

impl Posture {
    /// Frames in the world by their names in the log, of a limb with modules of these names.
    pub fn frames<'a>(&'a self, modules: &'a [String]) -> impl Iterator<Item = (String, Pose)> + 'a {
        let links = self.links.iter().enumerate().map(|(index, pose)| (link_frame(index), *pose));
        let connectors = modules.iter().zip(&self.connectors).map(|(name, pose)| (connector_frame(name), *pose));
        links.chain(connectors).chain([(TIP.to_owned(), self.tip)])
    }
}

/// Frame in the middle of a link of the limb.
pub(super) fn link_frame(index: usize) -> String {
    format!("limb_{index}")
}

/// Frame at the end of a module.
pub(super) fn connector_frame(module: &str) -> String {
    format!("connector_{module}")
}
