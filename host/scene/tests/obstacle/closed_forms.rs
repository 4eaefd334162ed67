//! Clearances that can be written down.

use std::f64::consts::{FRAC_PI_2, PI};

use fra_model::Segment;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use softlimb_scene::collision::{Body, Shape, TOLERANCE_M};

fn straight(length: f64, radius: f64) -> Body {
    let mut body = Body::new(&Isometry3::identity());
    body.rigid(length, radius);
    body
}

/// An arc of radius `r` in the x-z plane about the centre (r, 0, 0), from the origin upwards.
fn arc(r: f64, angle: f64, radius: f64) -> Body {
    let mut body = Body::new(&Isometry3::identity());
    body.module(&Segment { length_m: r * angle, bend_angle_rad: angle, twist_rad: 0.0 }, 0.0, radius);
    body
}

fn check(body: &Body, shape: &Shape, expected: f64) {
    let found = body.clearance(shape).unwrap();
    assert!((found.distance_m - expected).abs() <= TOLERANCE_M, "{found:?}, expected {expected}");
    let piece = &body.pieces()[found.piece];
    assert!((piece.point_m(found.share) - found.point_m).norm() < 1e-15);
    let there = shape.distance(&found.point_m);
    assert_eq!((there.distance_m - piece.radius_m(), there.gradient), (found.distance_m, found.away));
}

#[test]
fn two_rods() {
    let body = straight(1.0, 0.05);
    let beside = |x: f64, from: f64, to: f64| Shape::capsule([x, 0.0, from], [x, 0.0, to], 0.1).unwrap();
    check(&body, &beside(0.4, 0.0, 1.0), 0.25);
    check(&body, &beside(0.0, 2.0, 3.0), 0.85);
    check(&body, &beside(0.12, 0.0, 1.0), -0.03);
    // Crossing at a right angle in the distance 0.3, and skew lines whose ends are nearest.
    check(&body, &Shape::capsule([-1.0, 0.3, 0.5], [1.0, 0.3, 0.5], 0.1).unwrap(), 0.15);
    check(&body, &Shape::capsule([0.3, 0.0, 1.4], [0.3, 5.0, 1.4], 0.1).unwrap(), 0.5 - 0.15);
}

#[test]
fn rod_and_a_box() {
    let body = straight(1.0, 0.05);
    let none = UnitQuaternion::identity();
    check(&body, &Shape::cuboid([0.5, 0.0, 0.5], [0.1, 0.2, 0.3], none).unwrap(), 0.35);
    check(&body, &Shape::cuboid([0.0, 0.0, 1.5], [0.1, 0.2, 0.3], none).unwrap(), 0.15);
    // Turned by 45 degrees about z the nearest edge is half a diagonal off the centre.
    let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * (PI / 4.0));
    check(&body, &Shape::cuboid([0.5, 0.0, 0.5], [0.1, 0.1, 0.3], turned).unwrap(), 0.45 - 0.1 * 2.0_f64.sqrt());
    // Right through: the centre line leaves soonest through the near face.
    check(&body, &Shape::cuboid([0.02, 0.0, 0.5], [0.1, 0.2, 0.3], none).unwrap(), -0.08 - 0.05);
}

/// From the centre of its circle every point of an arc is as far: the second order bound cannot tell where the minimum is, and need not.
#[test]
fn arc_and_a_ball() {
    let body = arc(0.2, PI, 0.03);
    let ball = |x: f64, z: f64| Shape::sphere([x, 0.0, z], 0.05).unwrap();
    check(&body, &ball(0.2, 0.0), 0.2 - 0.08);
    check(&body, &ball(0.2, 0.5), 0.5 - 0.2 - 0.08);
    check(&body, &ball(0.2, 0.1), 0.1 - 0.08);
    // Below the ends, which are the nearest.
    check(&body, &ball(0.2, -0.3), 0.2_f64.hypot(0.3) - 0.08);
    // On the line itself.
    check(&body, &ball(0.2, 0.2), -0.08);
    check(&arc(0.2, FRAC_PI_2, 0.0), &ball(0.2, 0.2), -0.05);
}

/// A full circle of inner radius 0.15 about a rod through its middle, or off it by 0.04.
#[test]
fn ring_about_a_rod() {
    let body = arc(0.2, 2.0 * PI, 0.05);
    for off in [0.0, 0.04] {
        let rod = Shape::capsule([0.2 + off, -1.0, 0.0], [0.2 + off, 1.0, 0.0], 0.01).unwrap();
        check(&body, &rod, 0.2 - off - 0.05 - 0.01);
    }
}

#[test]
fn body_without_pieces_has_no_clearance_and_parts_of_no_length_have_no_piece() {
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let mut body = Body::new(&Isometry3::identity());
    assert_eq!(body.clearance(&ball), None);
    body.rigid(0.0, 1.0);
    assert!(body.pieces().is_empty());
    body.rigid(0.5, 0.0);
    body.restart(&Isometry3::translation(0.0, 0.0, 3.0));
    body.rigid(0.5, 0.1);
    check(&body, &ball, 1.9);
}

#[test]
fn shapes_that_are_not_finite_never_clear() {
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let mut body = Body::new(&Isometry3::translation(f64::NAN, 0.0, 0.0));
    body.rigid(0.5, 0.1);
    assert!(body.clearance(&ball).unwrap().distance_m.is_nan());
    assert!(!body.clears(&ball, 0.0));
}
