//! The centre line of one module in closed form, with its derivatives.
//!
//! The screw of rotation `w = (0, beta, tau)` and translation `(0, 0, l)` ends at `l V e_z`, where `V` is the left Jacobian of the
//! rotation, `V = 1 + a [w] + b [w]^2`, `a = (1 - cos t)/t^2`, `b = (t - sin t)/t^3`, `t = |w|`. Hence the point is
//! `l (a beta, b beta tau, 1 - b beta^2)`, and a change of the rotation by `dw` turns the end by `V dw`.

use nalgebra::{Matrix3, Vector3};
use softlimb_limb::arc::coefficients;

/// One end of an arc, seen from its start, with the derivatives of both its place and its direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    /// The end, m.
    pub(super) point: Vector3<f64>,
    /// Derivative of the end by length, bend and twist.
    pub(super) by: [Vector3<f64>; 3],
    /// Turn of the end per bend and per twist.
    pub(super) turn: [Vector3<f64>; 2],
    /// Direction of the end.
    pub(super) rotation: Matrix3<f64>,
}

/// The point of the centre line at a length, m, seen from the start, with a bend and a twist up to there, rad.
pub(super) fn point(length: f64, bend: f64, twist: f64) -> Vector3<f64> {
    let [a, b, ..] = coefficients(bend * bend + twist * twist);
    length * Vector3::new(a * bend, b * bend * twist, 1.0 - b * bend * bend)
}

impl Arc {
    pub(super) fn new(length: f64, bend: f64, twist: f64) -> Self {
        let square = bend * bend + twist * twist;
        let [a, b, a1, b1] = coefficients(square);
        let along = Vector3::new(a * bend, b * bend * twist, 1.0 - b * bend * bend);
        let by_square = Vector3::new(a1 * bend, b1 * bend * twist, -b1 * bend * bend);
        let by_bend = Vector3::new(a, b * twist, -2.0 * b * bend) + by_square * (2.0 * bend);
        let by_twist = Vector3::new(0.0, b * bend, 0.0) + by_square * (2.0 * twist);
        let turn_by_bend = Vector3::new(-a * twist, 1.0 - b * twist * twist, b * bend * twist);
        // exp[w] = 1 + sinc [w] + a [w]^2, with sinc = 1 - b t^2.
        let cross = Vector3::new(0.0, bend, twist).cross_matrix();
        let rotation = Matrix3::identity() + cross * (1.0 - b * square) + cross * cross * a;
        Self {
            point: length * along,
            by: [along, length * by_bend, length * by_twist],
            turn: [turn_by_bend, along],
            rotation,
        }
    }
}

#[cfg(test)]
mod tests {
    use fra_model::Segment;

    use super::*;

    /// Differences of the kinematics of the model, which multiplies quaternions and knows none of these formulas.
    #[test]
    fn ends_and_derivatives_are_those_of_the_kinematics() {
        let segment = |x: [f64; 3]| Segment { length_m: x[0], bend_angle_rad: x[1], twist_rad: x[2] }.pose();
        for x in [[0.2, 0.0, 0.0], [0.2, 0.05, 0.1], [0.2, 0.12, 0.17], [0.3, 1.3, -0.7], [0.1, 3.0, 2.0]] {
            let arc = Arc::new(x[0], x[1], x[2]);
            let pose = segment(x);
            assert!((arc.point - pose.translation.vector).norm() < 1e-15, "{x:?}");
            assert!((point(x[0], x[1], x[2]) - arc.point).norm() < 1e-16);
            assert!((arc.rotation - pose.rotation.to_rotation_matrix().matrix()).norm() < 1e-14, "{x:?}");
            for i in 0..3 {
                let h = 1e-5;
                let moved = |step: f64| {
                    let mut y = x;
                    y[i] += step;
                    segment(y)
                };
                let (forth, back) = (moved(h), moved(-h));
                let slope = (forth.translation.vector - back.translation.vector) / (2.0 * h);
                assert!((arc.by[i] - slope).norm() < 1e-9, "{x:?} {i}");
                let turn = (forth.rotation * back.rotation.inverse()).scaled_axis() / (2.0 * h);
                let expected = if i == 0 { Vector3::zeros() } else { arc.turn[i - 1] };
                assert!((expected - turn).norm() < 1e-9, "{x:?} {i}");
            }
        }
    }
}
