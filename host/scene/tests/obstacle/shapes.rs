//! Signed distances of single points.

use nalgebra::{UnitQuaternion, Vector3};
use softlimb_scene::collision::Shape;

use super::common::Random;

/// A step along the gradient changes the distance by as much; nothing changes faster; and the distance is convex.
#[test]
fn gradients_are_unit_and_distances_are_convex() {
    let mut random = Random::new(1);
    for _ in 0..3000 {
        let shape = random.shape(0.3);
        let (a, b) = (Vector3::from(random.point(0.5)), Vector3::from(random.point(0.5)));
        let (at_a, at_b) = (shape.distance(&a), shape.distance(&b));
        assert!((at_a.gradient.norm() - 1.0).abs() < 1e-12);
        assert!((at_a.distance_m - at_b.distance_m).abs() <= (a - b).norm() + 1e-12, "Lipschitz with 1");
        // A convex function lies above its tangent planes.
        assert!(at_b.distance_m >= at_a.distance_m + at_a.gradient.dot(&(b - a)) - 1e-12, "{shape:?} {a} {b}");
    }
}

/// From outside, going back by the distance along the gradient ends on the surface.
#[test]
fn gradient_leads_to_the_surface() {
    let mut random = Random::new(2);
    for _ in 0..3000 {
        let shape = random.shape(0.3);
        let point = Vector3::from(random.point(0.5));
        let there = shape.distance(&point);
        let surface = point - there.gradient * there.distance_m;
        assert!(shape.distance(&surface).distance_m.abs() < 1e-12, "{shape:?} {point}");
    }
}

#[test]
fn signs_and_values_by_hand() {
    let none = UnitQuaternion::identity();
    let cuboid = Shape::cuboid([1.0, 0.0, 0.0], [1.0, 2.0, 3.0], none).unwrap();
    let at = |shape: &Shape, point: [f64; 3]| shape.distance(&Vector3::from(point)).distance_m;
    assert_eq!(at(&cuboid, [1.0, 0.0, 0.0]), -1.0);
    assert_eq!(at(&cuboid, [1.0, 1.8, 0.0]), -(2.0 - 1.8));
    assert_eq!(at(&cuboid, [5.0, 6.0, 0.0]), 5.0);
    let capsule = Shape::capsule([0.0; 3], [0.0, 0.0, 2.0], 0.5).unwrap();
    assert_eq!(at(&capsule, [0.0, 0.0, 1.0]), -0.5);
    assert_eq!(at(&capsule, [3.0, 4.0, 1.0]), 4.5);
    assert_eq!(at(&capsule, [0.0, 0.0, 5.0]), 2.5);
    let ball = Shape::capsule([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25).unwrap();
    assert_eq!(at(&ball, [0.0; 3]), 0.75);
    // A quarter turn about z lays the edge along x where that along y was.
    let turned = Shape::cuboid(
        [0.0; 3],
        [1.0, 2.0, 3.0],
        UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2),
    );
    assert!((at(&turned.unwrap(), [3.0, 0.0, 0.0]) - 1.0).abs() < 1e-12);
}

#[test]
fn solids_that_are_none_are_refused_by_name() {
    let message = |shape: Result<Shape, softlimb_files::range::OutOfRange>| shape.unwrap_err().to_string();
    assert_eq!(message(Shape::sphere([0.0; 3], 0.0)), "radius_m = 0 is not allowed: finite and > 0");
    assert_eq!(message(Shape::sphere([0.0, f64::NAN, 0.0], 1.0)), "center_m = NaN is not allowed: finite");
    assert_eq!(message(Shape::capsule([0.0; 3], [f64::INFINITY, 0.0, 0.0], 1.0)), "to_m = inf is not allowed: finite");
    assert_eq!(
        message(Shape::cuboid([0.0; 3], [1.0, -1.0, 1.0], UnitQuaternion::identity())),
        "half_m = -1 is not allowed: finite and > 0"
    );
}
