//! What a loaded shape looks like: the deformation of each module, and the centre line.

use fra_model::{State, StateQuantity};
use nalgebra::{DVector, Vector3};

use super::load::LoadedLimb;
use super::rod::{Rod, STEPS, UNKNOWNS};
use super::solve::Shape;
use super::step::Step;
use crate::{Drive, Limb};
use softlimb_scene::collision::Body;

/// How a module is deformed under load, from end to end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deformed {
    /// Mean stretch of the bundle's axis.
    pub axial_stretch: f64,
    /// Bend towards the module's mount angle, and across it, rad.
    pub bend_angle_rad: [f64; 2],
    /// Twist, rad.
    pub twist_rad: f64,
}

impl Deformed {
    /// Mean stretch of an actuator at a place `[x, y]` of the section, m, in a module of this length at rest, m.
    pub fn stretch_at(&self, [x, y]: [f64; 2], length_m: f64) -> f64 {
        let [bend_x, bend_y] = self.bend_angle_rad;
        self.axial_stretch - (bend_x * x + bend_y * y) / length_m
    }
}

impl Drive<'_> {
    /// The value of its setpoint's quantity where its module is deformed like this; `None` for a quantity that belongs to a tube alone.
    pub fn deformed_value(&self, deformed: &Deformed) -> Option<f64> {
        match self.kind {
            StateQuantity::AxialStretch if self.is_steering() => {
                Some(deformed.stretch_at(self.position_m(), self.length_m()))
            }
            StateQuantity::AxialStretch => Some(deformed.axial_stretch),
            StateQuantity::BendAngle => Some(deformed.bend_angle_rad[0]),
            StateQuantity::Twist => Some(deformed.twist_rad),
            StateQuantity::Pressure | StateQuantity::OuterRadius | StateQuantity::InnerRadius => None,
        }
    }
}

impl LoadedLimb {
    /// Deformation of each module in a shape of `rod`, which may have each bundle in several pieces. That of a series is the sum over its segments,
    /// each towards its own direction.
    pub fn deformed(&self, rod: &Rod, shape: &Shape) -> Vec<Deformed> {
        let parts = (rod.pieces.len() / self.rod.pieces.len().max(1)).max(1);
        let mut all = vec![Deformed::default(); self.modules.last().map_or(0, |last| last + 1)];
        let mut lengths_m = vec![0.0; all.len()];
        let pieces = rod.pieces.chunks(parts).zip(shape.q.as_slice().chunks(parts * UNKNOWNS));
        for (module, (pieces, q)) in self.modules.iter().zip(pieces) {
            let sum = &mut all[*module];
            for (piece, q) in pieces.iter().zip(q.chunks(UNKNOWNS)) {
                let [stretch, x, y, twist] = piece.free;
                lengths_m[*module] += piece.length_m;
                sum.axial_stretch += (stretch + q[7]) * piece.length_m;
                // The slopes of the bends are odd along the piece.
                sum.bend_angle_rad[0] += (x + q[2]) * piece.length_m;
                sum.bend_angle_rad[1] += (y - q[0]) * piece.length_m;
                sum.twist_rad += (twist + q[4]) * piece.length_m;
            }
        }
        all.iter_mut().zip(lengths_m).for_each(|(sum, length_m)| sum.axial_stretch /= length_m);
        all
    }
}

impl Rod {
    /// Points along the centre line of a shape from the base to the tip, m: the ends of its steps and of its rigid parts.
    pub fn line_m(&self, shape: &Shape) -> Vec<[f64; 3]> {
        self.points_m(shape.q.as_slice())
    }
}

impl Limb {
    /// Makes `body` the limb as a solid at unknowns `q` of a chain of its parts, which may have each in several pieces; radii are those of
    /// [`Limb::shape`] in states without load, one a drive.
    pub fn loaded_shape<'a>(
        &self,
        rod: &Rod,
        q: &DVector<f64>,
        states: impl IntoIterator<Item = &'a State<f64>>,
        body: &mut Body,
    ) {
        body.restart(self.base());
        let parts = (rod.pieces.len() / self.parts().count().max(1)).max(1);
        let pieces = rod.pieces.chunks(parts).zip(q.as_slice().chunks(parts * UNKNOWNS));
        for ((module, link, radius_m), (pieces, q)) in self.links(states).zip(pieces) {
            for (piece, q) in pieces.iter().zip(q.chunks(UNKNOWNS)) {
                let turned = |vector: &Vector3<f64>| {
                    let (sin, cos) = piece.mount_angle_rad.sin_cos();
                    Vector3::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y, vector.z)
                };
                for step in 0..STEPS {
                    let [turn, shift] = Step::screw(piece, q, step);
                    body.screw(&turned(&turn), &turned(&shift), radius_m);
                }
            }
            // Nothing rigid is between the segments of a series.
            if link.rigid_length_m > 0.0 {
                module.rigid_shape(body);
            }
        }
    }
}
