//! Tasks that cannot be done, tasks on the edge, and tasks that make no sense.

use fra_model::{Actuator, Load, Motion};
use softlimb_design::actuators::Geometry;
use softlimb_design::synthesis::kinds::{Kind, space};
use softlimb_design::synthesis::{Budget, Obstacle, Shortfall, Space, Task, TaskError, WayPoint, design};
use softlimb_scene::collision::Shape;

const EFFORT: Budget = Budget { seed: 1, evaluations: 1500 };

fn task(way_points: &[[f64; 3]]) -> Task {
    let mut task = Kind::A.pose(1).unwrap().task;
    task.obstacles.clear();
    task.way_points = way_points.iter().map(|point| WayPoint::at(*point)).collect();
    task
}

fn modules(motions: &[Motion]) -> Vec<Space> {
    motions.iter().copied().map(space).collect()
}

#[test]
fn out_of_reach_is_answered_with_the_nearest_limb_and_its_distance() {
    let spaces = modules(&[Motion::Extension]);
    let task = task(&[[0.0, 0.0, 2.0]]);
    let found = design(&task, &spaces, &EFFORT).unwrap();
    // The longest actuator that stretches most: some corner of the section's bounds, since the stretch rises or falls with each of them.
    let mut longest: f64 = 0.0;
    for corner in 0..8 {
        let pick = |bit: u32, bounds: [f64; 2]| bounds[usize::from(corner & (1 << bit) != 0)];
        let bounds = &spaces[0].segment.bounds;
        let inner_radius_m = pick(0, bounds.sizes_m[0]);
        let geometry = Geometry {
            inner_radius_m,
            outer_radius_m: inner_radius_m + pick(1, bounds.sizes_m[1]),
            length_m: bounds.length_m[1],
            angle_rad: pick(2, bounds.angle_rad),
        };
        let actuator = Actuator::new(&spaces[0].segment.parameters(&geometry)).unwrap();
        let state = actuator.forward(spaces[0].segment.pressure_max_pa, &Load::none()).unwrap().state;
        longest = longest.max(state.axial_stretch * geometry.length_m);
    }
    let expected = 2.0 - longest - task.connector_m[0] - task.tool_m[0];
    assert!((found.way_points[0].tip_error_m - expected).abs() < 1e-4, "{:?} {expected}", found.way_points[0]);
    let Some(Shortfall::OutOfReach { way_point: 1, by_m }) = found.shortfall else { panic!("{:?}", found.shortfall) };
    assert!((by_m - expected).abs() < 1e-4);
}

#[test]
fn way_point_at_the_base_or_behind_it_is_out_of_reach_of_one_module() {
    let spaces = modules(&[Motion::Bending]);
    for point in [[0.0; 3], [0.0, 0.0, -0.2]] {
        let found = design(&task(&[point]), &spaces, &EFFORT).unwrap();
        let Some(Shortfall::OutOfReach { way_point: 1, by_m }) = found.shortfall else {
            panic!("{:?}", found.shortfall)
        };
        // No nearer than the end of a limb of the least length, rolled up as far as the highest pressure takes it, can be: not nothing.
        assert!(by_m > 1e-3 && (by_m - found.way_points[0].tip_error_m).abs() < 1e-9);
    }
}

#[test]
fn a_target_inside_an_obstacle_is_named() {
    let spaces = modules(&[Motion::Extension, Motion::Bending, Motion::Extension]);
    let mut task = task(&[[0.1, 0.0, 0.5], [0.12, 0.0, 0.52]]);
    let shape = Shape::sphere([0.12, 0.0, 0.53], 0.05).unwrap();
    task.obstacles = vec![Obstacle { name: "ball".into(), shape, clearance_m: 5e-3 }];
    let found = design(&task, &spaces, &EFFORT).unwrap();
    // 50 mm - 10 mm inside, 15 mm of tool and 5 mm of clearance.
    let Some(Shortfall::TargetBlocked { way_point, obstacle, by_m }) = found.shortfall.clone() else {
        panic!("{:?}", found.shortfall)
    };
    assert_eq!(obstacle, "ball");
    let expected = if way_point == 2 { 0.06 } else { 0.07 - 1300e-6_f64.sqrt() };
    assert!((by_m - expected).abs() < 1e-12, "{by_m} at {way_point}");
    assert!(found.shortfall.unwrap().to_string().contains("ball"));
}

#[test]
fn a_wall_before_the_target_is_named() {
    // A straight limb alone; a plate across its axis, with the target behind it.
    let spaces = modules(&[Motion::Extension]);
    let mut task = task(&[[0.0, 0.0, 0.3]]);
    let plate = Shape::cuboid([0.0, 0.0, 0.15], [0.5, 0.5, 0.01], nalgebra::UnitQuaternion::identity()).unwrap();
    task.obstacles = vec![Obstacle { name: "plate".into(), shape: plate, clearance_m: 0.0 }];
    let found = design(&task, &spaces, &EFFORT).unwrap();
    let Some(Shortfall::Obstacle { way_point: 1, obstacle, .. }) = found.shortfall else {
        panic!("{:?}", found.shortfall)
    };
    assert_eq!(obstacle, "plate");
}

#[test]
fn straight_limb_and_the_same_way_point_twice_are_no_trouble() {
    // Straight ahead a bending module has no direction: the tip does not move with its mount angle.
    let spaces = modules(&[Motion::Extension, Motion::Bending]);
    let straight = [0.0, 0.0, 0.45];
    let found = design(&task(&[straight, straight, [0.05, 0.0, 0.44], straight]), &spaces, &EFFORT).unwrap();
    assert!(found.does_it(), "{:?}", found.shortfall);
}

#[test]
fn nonsense_is_refused_with_its_place() {
    let spaces = modules(&[Motion::Extension]);
    let good = task(&[[0.0, 0.0, 0.3]]);
    let message = |task: &Task, spaces: &[Space]| design(task, spaces, &EFFORT).unwrap_err().to_string();
    let mut bad = good.clone();
    bad.way_points[0].weight = 0.0;
    assert_eq!(message(&bad, &spaces), "way-point 1: weight = 0 is not allowed: finite and > 0");
    assert_eq!(
        message(&Task { way_points: Vec::new(), ..good.clone() }, &spaces),
        "way_points: 0 is not allowed: 1 to 100"
    );
    assert_eq!(message(&good, &[]), "modules and segments: 0 is not allowed: 1 to 16");
    let alike = "no geometry within the bounds can be solved: a segment has the radii, the pressure and the places of the one before it";
    let mut segments = modules(&[Motion::Extension, Motion::Bending]);
    segments[1].joined = true;
    segments[1].segment.bounds.sizes_m[1][1] += 1e-3;
    assert_eq!(message(&good, &segments), format!("module bending: {alike}"));
    let mut first = spaces.clone();
    first[0].joined = true;
    assert_eq!(message(&good, &first), format!("module extension: {alike}"));
    let mut inverted = spaces.clone();
    inverted[0].segment.bounds.length_m = [0.3, 0.1];
    assert_eq!(
        message(&good, &inverted),
        "module extension: length_m = 0.1 is not allowed: finite and >= the lower bound 0.3"
    );
    let mut nothing = spaces.clone();
    nothing[0].segment.material = fra_model::Material::NeoHookean { shear_modulus_pa: -1.0 };
    assert!(matches!(design(&good, &nothing, &EFFORT), Err(TaskError::Bounds { .. })));
}
