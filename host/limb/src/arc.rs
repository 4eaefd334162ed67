//! A centre line of constant strain: where it ends, and how its end moves with its parameters.
//!
//! With the turn `w` of the end against the start, `e` the first tangent and `L` the length, the end lies at
//! `p = L (e + f1 w x e + f2 w x (w x e))`, and a change `dw` turns it by `V dw`, `V = 1 + f1 [w] + f2 [w]^2`. Both are differentiated as
//! they stand.

use fra_model::Segment;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// What a change of something moves: the velocity of a place, and the rate of rotation of all that lies behind it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Twist {
    /// Velocity of the place, m per unit of what changes.
    pub velocity: Vector3<f64>,
    /// Rate of rotation, rad per unit of what changes.
    pub rotation: Vector3<f64>,
}

/// A centre line that starts along `z`, bent and twisted evenly; or a change of one.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    /// Its length, m.
    pub(crate) length_m: f64,
    /// Turn of its end, rad: about `x`, about `y` (which bends it towards `x`), and its twist.
    pub(crate) turn_rad: Vector3<f64>,
}

impl From<&Segment<f64>> for Arc {
    fn from(segment: &Segment<f64>) -> Self {
        Self { length_m: segment.length_m, turn_rad: Vector3::new(0.0, segment.bend_angle_rad, segment.twist_rad) }
    }
}

impl Arc {
    /// Pose of its end, seen from its start.
    pub(crate) fn pose(&self) -> Isometry3<f64> {
        let [f1, f2, ..] = coefficients(self.turn_rad.norm_squared());
        let sideways = self.turn_rad.cross(&Vector3::z());
        let path = Vector3::z() + sideways * f1 + self.turn_rad.cross(&sideways) * f2;
        let end = Translation3::from(path * self.length_m);
        Isometry3::from_parts(end, UnitQuaternion::from_scaled_axis(self.turn_rad))
    }

    /// Change of its end, seen from its start, for a change of its parameters.
    pub fn change(&self, by: &Self) -> Twist {
        let (w, dw, e) = (self.turn_rad, by.turn_rad, Vector3::z());
        let [f1, f2, g1, g2] = coefficients(w.norm_squared());
        let (we, dwe) = (w.cross(&e), dw.cross(&e));
        let inwards = w.cross(&we);
        // Change of the square of the angle.
        let turn = 2.0 * w.dot(&dw);
        let path = e + we * f1 + inwards * f2;
        let change_of_path = dwe * f1 + we * (g1 * turn) + (dw.cross(&we) + w.cross(&dwe)) * f2 + inwards * (g2 * turn);
        let across = w.cross(&dw);
        Twist {
            velocity: path * by.length_m + change_of_path * self.length_m,
            rotation: dw + across * f1 + w.cross(&across) * f2,
        }
    }
}

/// Square of the angle below which the coefficients are series: their quotients cancel there.
const SMALL: f64 = 0.04;

/// `f1 = (1 - cos t)/t^2`, `f2 = (t - sin t)/t^3`, and their derivatives by `t^2`, of `t^2`.
pub fn coefficients(square: f64) -> [f64; 4] {
    let q = square;
    if q < SMALL {
        let series = |c: [f64; 5]| c[0] + q * (c[1] + q * (c[2] + q * (c[3] + q * c[4])));
        return [
            series([0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0, 1.0 / 3_628_800.0]),
            series([1.0 / 6.0, -1.0 / 120.0, 1.0 / 5040.0, -1.0 / 362_880.0, 1.0 / 39_916_800.0]),
            series([-1.0 / 24.0, 1.0 / 360.0, -1.0 / 13_440.0, 1.0 / 907_200.0, -1.0 / 95_800_320.0]),
            series([-1.0 / 120.0, 1.0 / 2520.0, -1.0 / 120_960.0, 1.0 / 9_979_200.0, -1.0 / 1_245_404_160.0]),
        ];
    }
    let t = q.sqrt();
    let (sin, cos) = t.sin_cos();
    let (half, sinc) = ((0.5 * t).sin(), sin / t);
    let (f1, f2) = (2.0 * half * half / q, (1.0 - sinc) / q);
    [f1, f2, (0.5 * sinc - f1) / q, ((sinc - cos) / (2.0 * q) - f2) / q]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(bend: f64, twist: f64, h: f64) -> Segment<f64> {
        Segment { length_m: 0.2 + 0.3 * h, bend_angle_rad: bend + 1.1 * h, twist_rad: twist - 0.6 * h }
    }

    /// Against the kinematics of `fra-model` and their differences, on both sides of the series' end; the same about another axis.
    #[test]
    fn changes_are_the_derivatives_of_poses() {
        for (bend, twist) in [(0.0, 0.0), (1e-3, 0.0), (0.2, -0.21), (0.25, -0.18), (1.3, 0.7), (0.0, 3.0), (4.0, 0.0)]
        {
            for about_z in [0.0, 0.7] {
                // Turned about its first tangent, an arc is the same arc seen from another side.
                let seen = UnitQuaternion::from_scaled_axis(Vector3::z() * about_z);
                let arc = |segment: &Segment<f64>| {
                    let arc = Arc::from(segment);
                    Arc { turn_rad: seen * arc.turn_rad, ..arc }
                };
                let pose = |h: f64| seen * segment(bend, twist, h).pose() * seen.inverse();
                let here = arc(&segment(bend, twist, 0.0));
                let found = here.change(&arc(&Segment { length_m: 0.3, bend_angle_rad: 1.1, twist_rad: -0.6 }));
                let h = 1e-5;
                let (before, after) = (pose(-h), pose(h));
                let velocity = (after.translation.vector - before.translation.vector) / (2.0 * h);
                let rotation = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
                assert!((found.velocity - velocity).norm() < 1e-9, "{bend} {twist}: {} {velocity}", found.velocity);
                assert!((found.rotation - rotation).norm() < 1e-9, "{bend} {twist}: {} {rotation}", found.rotation);
                let (own, model) = (here.pose(), pose(0.0));
                assert!((own.translation.vector - model.translation.vector).norm() < 1e-12, "{bend} {twist}");
                assert!(own.rotation.angle_to(&model.rotation) < 1e-7, "{bend} {twist}");
            }
        }
    }
}
