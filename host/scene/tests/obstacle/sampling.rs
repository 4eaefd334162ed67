//! Random bodies and solids, against dense samples of the limb's kinematics.

use fra_model::Link;
use nalgebra::Translation3;

use super::common::{Parts, Random};
use softlimb_scene::collision::{Shape, TOLERANCE_M};

/// The least distance over samples of the poses of `fra-model`, and the largest step between samples.
fn sampled(parts: &Parts, shape: &Shape, steps: usize) -> (f64, f64) {
    let (mut pose, mut least, mut step) = (parts.base, f64::INFINITY, 0.0_f64);
    for ((segment, mount_angle_rad, radius), (rigid_length_m, rigid_radius)) in parts.modules.iter().zip(&parts.rigid) {
        let link = Link { segment: *segment, mount_angle_rad: *mount_angle_rad, rigid_length_m: *rigid_length_m };
        for index in 0..=steps {
            let share = index as f64 / steps as f64;
            let at = (pose * link.pose_at(share)).translation.vector;
            least = least.min(shape.distance(&at).distance_m - radius);
            let along = pose * link.pose_at(1.0) * Translation3::new(0.0, 0.0, share * rigid_length_m);
            least = least.min(shape.distance(&along.translation.vector).distance_m - rigid_radius);
        }
        pose *= link.pose();
        step = step.max(segment.length_m.max(*rigid_length_m) / steps as f64);
    }
    (least, step)
}

/// Nothing sampled is nearer, and a sample is as near but for half a step (the distance is Lipschitz with 1).
#[test]
fn samples_are_no_nearer_than_the_clearance() {
    let mut random = Random::new(7);
    let mut overlaps = 0;
    for case in 0..400 {
        let (parts, shape) = (random.parts(), random.shape(0.3));
        let found = parts.body().clearance(&shape).unwrap().distance_m;
        let (least, step) = sampled(&parts, &shape, 2000);
        assert!(found <= least + TOLERANCE_M, "case {case}: {found} above {least}");
        assert!(found >= least - 0.5 * step - TOLERANCE_M, "case {case}: {found} below {least}");
        overlaps += u32::from(found < 0.0);
    }
    assert!((40..360).contains(&overlaps), "{overlaps} of 400 overlap");
}

/// The body's own formula of the arc against the poses of the kinematics, and its end.
#[test]
fn pieces_are_the_limb_of_the_kinematics() {
    let mut random = Random::new(8);
    for _ in 0..100 {
        let parts = random.parts();
        let body = parts.body();
        let mut pose = parts.base;
        let mut pieces = body.pieces().iter();
        for ((segment, mount_angle_rad, _), (rigid_length_m, _)) in parts.modules.iter().zip(&parts.rigid) {
            let link = Link { segment: *segment, mount_angle_rad: *mount_angle_rad, rigid_length_m: *rigid_length_m };
            let piece = pieces.next().unwrap();
            for share in [0.0, 0.01, 0.3, 0.77, 1.0] {
                let expected = pose * link.pose_at(share);
                assert!((piece.point_m(share) - expected.translation.vector).norm() < 1e-12);
                let apart = piece.pose(share).inverse() * expected;
                assert!(apart.translation.vector.norm() < 1e-12 && apart.rotation.angle() < 1e-7, "{apart}");
            }
            pose *= link.pose();
            if *rigid_length_m > 0.0 {
                assert!((pieces.next().unwrap().point_m(1.0) - pose.translation.vector).norm() < 1e-12);
            }
        }
        assert!((body.end().translation.vector - pose.translation.vector).norm() < 1e-12);
        assert!(body.end().rotation.angle_to(&pose.rotation) < 1e-7);
    }
}

#[test]
fn sufficient_distance_agrees_with_the_clearance() {
    let mut random = Random::new(9);
    for _ in 0..400 {
        let (body, shape) = (random.parts().body(), random.shape(0.6));
        let clearance = body.clearance(&shape).unwrap().distance_m;
        assert!(body.clears(&shape, clearance - 2.0 * TOLERANCE_M));
        assert!(!body.clears(&shape, clearance + 1e-12));
        let enough = clearance + random.between(2e-6, 0.2);
        let found = body.nearest(&shape, enough).unwrap().distance_m;
        assert!((found - clearance).abs() <= TOLERANCE_M, "{found} {clearance}");
        assert_eq!(body.nearest(&shape, clearance - 2.0 * TOLERANCE_M), None);
    }
}
