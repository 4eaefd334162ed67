//! Limb kinematics against plane geometry and against many small rigid steps.

use fra_model::*;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

fn segment(length_m: f64, bend_angle_rad: f64, twist_rad: f64) -> Segment<f64> {
    Segment { length_m, bend_angle_rad, twist_rad }
}

#[test]
fn a_bent_segment_is_a_circular_arc() {
    for angle in [1e-9, 1e-3, 0.0999, 0.1001, 1.0, 3.0, 7.0] {
        let tip = segment(0.24, angle, 0.0).pose();
        let radius = 0.24 / angle;
        let expected = Vector3::new(radius * 2.0 * (angle / 2.0).sin().powi(2), 0.0, radius * angle.sin());
        assert!((tip.translation.vector - expected).norm() < 1e-15 / angle.min(1.0), "{angle}: {tip}");
        let tangent = tip * Vector3::z();
        assert!((tangent - Vector3::new(angle.sin(), 0.0, angle.cos())).norm() < 1e-14);
    }
}

#[test]
fn bend_and_twist_together_are_the_limit_of_small_steps() {
    let s = segment(0.3, 1.1, 0.7);
    let n = 20_000;
    let share = 1.0 / f64::from(n);
    // Midpoint steps: half a turn, a straight piece, half a turn.
    let half_turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 1.1, 0.7) * share / 2.0);
    let step = half_turn * Isometry3::from(Translation3::new(0.0, 0.0, 0.3 * share)) * half_turn;
    let walked = (0..n).fold(Isometry3::identity(), |pose, _| pose * step);
    assert!((walked.translation.vector - s.pose().translation.vector).norm() < 1e-9);
    assert!(walked.rotation.angle_to(&s.pose().rotation) < 1e-9);
}

#[test]
fn mount_angles_turn_the_bend_and_do_not_add_up() {
    let bend = |mount_angle_rad| Link { segment: segment(0.2, 0.8, 0.0), mount_angle_rad, rigid_length_m: 0.03 };
    let base = Isometry3::identity();
    let first = tip_pose(&base, [bend(std::f64::consts::FRAC_PI_2)]);
    assert!(first.translation.x.abs() < 1e-15 && first.translation.y > 0.05);
    // Two equal modules in the same direction: one arc of twice the angle, with the connector in between.
    let both = tip_pose(&base, [bend(1.0), bend(1.0)]);
    let tangent = both * Vector3::z();
    assert!((tangent.z - 1.6_f64.cos()).abs() < 1e-14);
    assert!((tangent.y / tangent.x - 1.0_f64.tan()).abs() < 1e-12);
}

/// Length of the parallel line through a place of the section, m, as a chain of many short chords between the turned sections of an arc.
fn parallel_m(segment: &Segment<f64>, towards_rad: f64, place: &Vector3<f64>) -> f64 {
    let link = Link { segment: *segment, mount_angle_rad: towards_rad, rigid_length_m: 0.0 };
    let chords = 4000;
    let point = |index: usize| (link.pose_at(index as f64 / chords as f64) * nalgebra::Point3::from(*place)).coords;
    (0..chords).map(|index| (point(index + 1) - point(index)).norm()).sum()
}

/// Against the lengths of parallel lines in space: each actuator of three is as long as its stretch says.
#[test]
fn steering_bundle_has_its_actuators_at_their_lengths() {
    let (length_m, radius_m) = (0.2, 0.031);
    for stretches in [[1.0, 1.0, 1.0], [1.3, 1.1, 1.1], [1.05, 1.21, 1.34], [1.4, 1.0, 1.2], [1.0, 1.0, 1.5]] {
        let (segment, towards_rad) = Segment::of_stretches(length_m, radius_m, &stretches).unwrap();
        for (index, stretch) in stretches.iter().enumerate() {
            let (sin, cos) = (std::f64::consts::TAU * index as f64 / 3.0).sin_cos();
            let found = parallel_m(&segment, towards_rad, &Vector3::new(radius_m * cos, radius_m * sin, 0.0));
            assert!((found / length_m - stretch).abs() < 1e-7, "{stretches:?} {index}: {}", found / length_m);
        }
    }
    let (_, towards_rad) = Segment::of_stretches(length_m, radius_m, &[1.0, 1.2, 1.2]).unwrap();
    assert!(towards_rad.abs() < 1e-12, "it bends towards the shortest: {towards_rad}");
}

/// Four to nine actuators: no arc nearby has parallel lines whose lengths are nearer, by a search in steps.
#[test]
fn steering_bundle_of_many_is_the_nearest_arc() {
    let (length_m, radius_m) = (0.18, 0.04);
    for count in 4..=9_usize {
        let angle = |index: usize| std::f64::consts::TAU * index as f64 / count as f64;
        let stretches: Vec<f64> = (0..count).map(|index| 1.2 + 0.15 * (2.7 * index as f64).sin()).collect();
        let (segment, towards_rad) = Segment::of_stretches(length_m, radius_m, &stretches).unwrap();
        let bend = segment.bend_angle_rad / length_m;
        let here = [segment.length_m / length_m, bend * towards_rad.cos(), bend * towards_rad.sin()];
        let off = |[stretch, x, y]: [f64; 3]| -> f64 {
            let own = |index: usize| stretch - radius_m * (x * angle(index).cos() + y * angle(index).sin());
            (0..count).map(|index| (own(index) - stretches[index]).powi(2)).sum()
        };
        for axis in 0..3 {
            for step in [-1e-4, 1e-4] {
                let mut there = here;
                there[axis] += step;
                assert!(off(there) > off(here), "{count} {axis}");
            }
        }
    }
}

#[test]
fn steering_bundle_needs_three_actuators_on_a_circle() {
    assert!(Segment::of_stretches(0.2, 0.03, &[1.1, 1.2]).is_none());
    assert!(Segment::of_stretches(0.2, 0.0, &[1.1, 1.2, 1.3]).is_none());
    assert!(Segment::of_stretches(0.2, 0.03, &[-1.1, 0.2, 0.3]).is_none());
}

#[test]
fn a_twisting_bundle_shortens_by_its_helices() {
    let actuator = Actuator::new(&ActuatorParameters {
        motion: Motion::Twisting,
        inner_radius_m: 0.01,
        outer_radius_m: 0.014,
        length_m: 0.24,
        material: Material::NeoHookean { shear_modulus_pa: 0.22e6 },
        fiber: Some(Fiber {
            angle_rad: 28.0_f64.to_radians(),
            families: Families::One,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            radius_m: 0.014,
        }),
    })
    .unwrap();
    let state = actuator.forward(20e3, &Load::none()).unwrap().state;
    let s = Segment::of_bundle(Motion::Twisting, 0.24, 0.02, &state).unwrap();
    let helix = (s.length_m.powi(2) + (0.02 * s.twist_rad).powi(2)).sqrt();
    assert!((helix - 0.24 * state.axial_stretch).abs() < 1e-15);
    let impossible = State { twist_rad: 20.0, ..state };
    assert!(Segment::of_bundle(Motion::Twisting, 0.24, 0.02, &impossible).is_none());
}

/// Places by hand: a row along `y`, a circle from `x` on. Distances are those of the places, which the shortcuts do not use.
#[test]
fn bundles_have_their_places() {
    let row: Vec<_> = Arrangement::Row { spacing_m: 0.03 }.positions_m(4).collect();
    let expected = [[0.0, -0.045], [0.0, -0.015], [0.0, 0.015], [0.0, 0.045]];
    for (found, expected) in row.iter().zip(expected) {
        assert!(found.iter().zip(expected).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-17), "{row:?}");
    }
    let circle: Vec<_> = Arrangement::Circle { radius_m: 2.0 }.positions_m(3).collect();
    let root = 3.0_f64.sqrt();
    for (found, expected) in circle.iter().zip([[2.0, 0.0], [-1.0, root], [-1.0, -root]]) {
        assert!(found.iter().zip(expected).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-15), "{circle:?}");
    }
    for arrangement in [Arrangement::Circle { radius_m: 0.03_f64 }, Arrangement::Row { spacing_m: 0.03 }] {
        assert_eq!(arrangement.nearest_m(1), None);
        for count in 2..=9 {
            let places: Vec<_> = arrangement.positions_m(count).collect();
            let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
            let pairs = (0..places.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            let nearest = pairs.map(|(i, j)| apart(&places[i], &places[j])).fold(f64::INFINITY, f64::min);
            let reach = places.iter().map(|place| place[0].hypot(place[1])).fold(0.0, f64::max);
            assert!((arrangement.nearest_m(count).unwrap() - nearest).abs() < 1e-15, "{arrangement:?} {count}");
            assert!((arrangement.reach_m(count) - reach).abs() < 1e-15, "{arrangement:?} {count}");
        }
    }
    assert_eq!(Arrangement::Row { spacing_m: 0.03 }.reach_m(1), 0.0);
}
