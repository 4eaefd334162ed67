//! Lines on the surface of a solid, from which its picture is drawn.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::shape::Shape;

/// Points of a circle.
const AROUND: usize = 48;

impl Shape {
    /// Lines on the surface, m: seen along any axis of the scene they hold the outline.
    pub fn outlines(&self) -> Vec<Vec<[f64; 3]>> {
        match self {
            Self::Sphere { center_m, radius_m } => circles(center_m, *radius_m),
            Self::Capsule { from_m, to_m, radius_m } => {
                let mut lines = circles(from_m, *radius_m);
                lines.extend(circles(to_m, *radius_m));
                let axis = to_m - from_m;
                // Along each axis of the scene: the two lines that touch both end circles.
                for view in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    let Some(side) = axis.cross(&view).try_normalize(1e-12) else { continue };
                    let line = |way: f64| [from_m, to_m].map(|end| (end + side * (way * radius_m)).into()).to_vec();
                    lines.extend([line(1.0), line(-1.0)]);
                }
                lines
            }
            Self::Box { center_m, half_m, rotation } => {
                let corner =
                    |signs: [f64; 3]| (center_m + rotation * half_m.component_mul(&Vector3::from(signs))).into();
                let edge = |axis: usize, a: f64, b: f64| {
                    let end = |sign: f64| {
                        let mut signs = [a, b, a];
                        signs[axis] = sign;
                        signs[(axis + 1) % 3] = a;
                        signs[(axis + 2) % 3] = b;
                        corner(signs)
                    };
                    vec![end(-1.0), end(1.0)]
                };
                let sides = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
                (0..3).flat_map(|axis| sides.map(|(a, b)| edge(axis, a, b))).collect()
            }
        }
    }
}

/// Three great circles, each across one axis of the scene.
fn circles(center_m: &Vector3<f64>, radius_m: f64) -> Vec<Vec<[f64; 3]>> {
    let circle = |axis: usize| {
        let point = |step: usize| {
            let (sine, cosine) = (TAU * step as f64 / AROUND as f64).sin_cos();
            let mut at = *center_m;
            at[(axis + 1) % 3] += radius_m * cosine;
            at[(axis + 2) % 3] += radius_m * sine;
            at.into()
        };
        (0..=AROUND).map(point).collect()
    };
    (0..3).map(circle).collect()
}
