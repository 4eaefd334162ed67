//! The limb as a chain of links: its centre line and its solid.

use fra_model::{Link, State};
use nalgebra::{Isometry3, Point3};

use softlimb_scene::collision::Body;

use crate::{Limb, LimbModule};

/// Points per link on the drawn centre line.
const BACKBONE_POINTS: usize = 12;

/// The links of a limb in states that are known for each segment of a series, too: of an actuator that differs from its model.
#[derive(Clone, Debug)]
pub struct Chain<'a> {
    base: Isometry3<f64>,
    links: Vec<(&'a LimbModule, Link<f64>, f64)>,
}

impl Limb {
    /// The limb in states, one a drive, and in states of the segments of each module. Of a module that is no series, and of one whose list is
    /// empty, the segments are not read.
    pub fn chain(&self, states: &[State<f64>], segments: &[Vec<State<f64>>]) -> Chain<'_> {
        Chain { base: *self.base(), links: self.links_made(states, segments).collect() }
    }
}

impl Chain<'_> {
    /// Position of the tip, m.
    pub fn tip(&self) -> [f64; 3] {
        fra_model::tip_pose(&self.base, self.links.iter().map(|(_, link, _)| *link)).translation.vector.into()
    }

    /// The limb as a solid, as [`Limb::body`].
    pub fn body(&self) -> Body {
        let mut body = Body::new(&self.base);
        shape(&self.base, self.links.iter().copied(), &mut body);
        body
    }

    /// Points along the centre line, as [`Limb::backbone`], m.
    pub fn backbone(&self) -> Vec<[f64; 3]> {
        backbone(&self.base, self.links.iter().copied())
    }
}

/// Makes `body` that of links.
pub(crate) fn shape<'a>(
    base: &Isometry3<f64>,
    links: impl Iterator<Item = (&'a LimbModule, Link<f64>, f64)>,
    body: &mut Body,
) {
    body.restart(base);
    for (module, link, radius_m) in links {
        body.module(&link.segment, link.mount_angle_rad, radius_m);
        // Nothing rigid is between the segments of a series.
        if link.rigid_length_m > 0.0 {
            module.rigid_shape(body);
        }
    }
}

/// Points along the centre line of links, m.
pub(crate) fn backbone<'a>(
    base: &Isometry3<f64>,
    links: impl Iterator<Item = (&'a LimbModule, Link<f64>, f64)>,
) -> Vec<[f64; 3]> {
    let mut pose = *base;
    let mut points = vec![pose.translation.vector.into()];
    for (_, link, _) in links {
        for step in 1..=BACKBONE_POINTS {
            let share = step as f64 / BACKBONE_POINTS as f64;
            points.push((pose * link.pose_at(share)).translation.vector.into());
        }
        pose *= link.pose();
        points.push((pose * Point3::origin()).coords.into());
    }
    points
}
