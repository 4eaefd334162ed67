//! Space has no preferred direction, and no preferred hand but that of the windings.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use softlimb_design::synthesis::kinds::Kind;
use softlimb_design::synthesis::{Aim, Budget, Evaluator, Task, design};
use softlimb_scene::collision::Shape;

/// The task with every point carried over by `point` and every direction of a box by `turn`.
fn carried(
    task: &Task,
    point: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    turn: impl Fn(&UnitQuaternion<f64>) -> UnitQuaternion<f64>,
) -> Task {
    let mut task = task.clone();
    for way_point in &mut task.way_points {
        let Some(Aim::Point(aim)) = &mut way_point.aim else { panic!("a point") };
        *aim = point(aim);
    }
    for obstacle in &mut task.obstacles {
        match &mut obstacle.shape {
            Shape::Sphere { center_m, .. } => *center_m = point(center_m),
            Shape::Capsule { from_m, to_m, .. } => (*from_m, *to_m) = (point(from_m), point(to_m)),
            Shape::Box { center_m, rotation, .. } => (*center_m, *rotation) = (point(center_m), turn(rotation)),
        }
    }
    task
}

#[test]
fn task_carried_elsewhere_is_done_by_the_same_limb() {
    for (kind, seed) in [(Kind::C, 1), (Kind::E, 4), (Kind::B, 2)] {
        let posed = kind.pose(seed).unwrap();
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -1.1, 0.7));
        let motion = Isometry3::from_parts(Translation3::new(0.3, -2.0, 1.1), rotation);
        let mut moved = carried(&posed.task, |p| rotation * p + motion.translation.vector, |r| rotation * r);
        moved.base = motion * posed.task.base;
        let effort = Budget::default();
        let here = design(&posed.task, &posed.spaces, &effort).unwrap();
        let there = design(&moved, &posed.spaces, &effort).unwrap();
        assert!(here.does_it() && there.does_it());
        for (a, b) in here.modules.iter().zip(&there.modules) {
            assert!((a.length_m - b.length_m).abs() < 1e-6, "{kind:?}: {} {}", a.length_m, b.length_m);
            assert!((a.inner_radius_m - b.inner_radius_m).abs() < 1e-6);
            assert!((a.mount_angle_rad - b.mount_angle_rad).abs() < 1e-5);
        }
        for (a, b) in here.way_points.iter().zip(&there.way_points) {
            assert!(a.pressure_pa.iter().zip(&b.pressure_pa).all(|(a, b)| (a - b).abs() < 1.0), "{a:?} {b:?}");
        }
    }
}

#[test]
fn mirrored_task_is_done_by_the_mirrored_limb() {
    // Mirrored at the plane y = 0: a module that bends towards the angle a bends towards -a. Two-family windings have no hand.
    for kind in [Kind::A, Kind::C, Kind::E] {
        let posed = kind.pose(5).unwrap();
        let mirror = |p: &Vector3<f64>| Vector3::new(p.x, -p.y, p.z);
        let turn =
            |r: &UnitQuaternion<f64>| UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(r.w, -r.i, r.j, -r.k));
        let mirrored = carried(&posed.task, mirror, turn);
        let here = Evaluator::new(&posed.task, &posed.spaces).unwrap();
        let there = Evaluator::new(&mirrored, &posed.spaces).unwrap();
        // Place of the mount angles: after the three (bending: two sizes) and the length of every module.
        let mut mounts = Vec::new();
        let mut index = 0;
        for motion in kind.motions() {
            index += 3;
            if motion == fra_model::Motion::Bending {
                mounts.push(index);
            }
            index += 1;
        }
        let mut differ = 0;
        for case in 0..20 {
            let place: Vec<f64> =
                (0..here.width()).map(|i| (0.37 * i as f64 + 0.311 * f64::from(case)).fract()).collect();
            let mut other = place.clone();
            mounts.iter().for_each(|index| other[*index] = 1.0 - place[*index]);
            let (a, b) = (here.objective(&place), there.objective(&other));
            assert!((a - b).abs() <= 1e-9 * (a + b), "{kind:?}: {a} {b}");
            differ += usize::from((there.objective(&place) - a).abs() > 1e-3 * a);
        }
        assert!(differ > 15, "the mirror makes a difference");
    }
}
