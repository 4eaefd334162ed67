//! Tasks at the edge of sense.

use super::common::{off, planned, refused, tip_after, with_phases};

/// The tip of the straight limb: 3 modules of 240 mm with connectors of 15 mm, and a tool of 50 mm.
const STRAIGHT: &str = "[0.815, 0.0, 1.1]";

fn phase(name: &str, goal: &str) -> String {
    format!("[[phase]]\nname = \"{name}\"\n{goal}\n")
}

#[test]
fn goal_where_the_limb_is_needs_no_pressure_and_the_shortest_time() {
    for tool in ["tip-waypoints", "reach-past-post"] {
        let text = with_phases(tool, &phase("stay", &format!("tip = {STRAIGHT}")));
        let (_, limb, plan) = planned(&text).unwrap();
        assert!(off(&limb, &plan, 0, [0.815, 0.0, 1.1]) < 1e-4);
        let end = plan.states_at(plan.duration_us() as f64);
        assert!(end.iter().all(|state| state.pressure_pa < 20.0), "{end:?}");
        assert_eq!(plan.phases[0].move_us, 100_000);
    }
}

#[test]
fn singular_straight_pose_is_reached_from_a_bent_one() {
    let bent = "targets = { elbow = { bend_angle = \"60 deg\" }, wrist = { axial_stretch = 1.1 } }";
    let tables = phase("bent", bent) + &phase("straight", &format!("tip = {STRAIGHT}"));
    let (_, limb, plan) = planned(&with_phases("weightless-a", &tables)).unwrap();
    assert!(off(&limb, &plan, 1, [0.815, 0.0, 1.1]) < 1e-4);
}

#[test]
fn target_behind_the_base_is_refused_with_the_nearest_point() {
    let message = refused(&with_phases("weightless-a", &phase("behind", "tip = [-0.3, 0.0, 1.1]")));
    assert!(message.contains("the limb cannot reach this way-point"), "{message}");
    assert!(message.contains("tip = [-0.3") && message.contains("the nearest reachable point is"), "{message}");
}

#[test]
fn obstacle_at_the_base_is_refused_at_its_table() {
    let tables = "[[obstacle]]\nname = \"wall\"\nshape = \"sphere\"\ncenter = [0, 0, 1.1]\nradius = \"50 mm\"\n"
        .to_owned()
        + &phase("stay", &format!("tip = {STRAIGHT}"));
    let message = refused(&with_phases("weightless-a", &tables));
    assert!(message.contains("the limb at rest is too near this obstacle") && message.contains("wall"), "{message}");
    // The bundle is 44 mm thick about a line through the ball's centre.
    assert!(message.contains("94.0 mm deep"), "{message}");
}

#[test]
fn phase_of_no_time_is_refused_and_a_way_point_twice_is_not() {
    let none = with_phases("weightless-a", &phase("now", &format!("tip = {STRAIGHT}\nduration = \"0 s\"")));
    assert!(refused(&none).contains("`duration` must be from 0.02 s"));
    let point = "tip = [0.66, 0.0, 0.68]";
    let (_, limb, plan) = planned(&with_phases("weightless-a", &(phase("a", point) + &phase("b", point)))).unwrap();
    assert!(off(&limb, &plan, 1, [0.66, 0.0, 0.68]) < 1e-4);
    // The second move only corrects what the first left, some 1e-7 m.
    let moved = plan.phases[0].values.iter().zip(&plan.phases[1].values).map(|(a, b)| (a - b).abs());
    assert!(moved.fold(0.0, f64::max) < 1e-3);
    assert_eq!(plan.phases[1].move_us, 100_000);
}

/// Point and direction that do not go together: the refusal names a tolerance, and with that it can be planned.
#[test]
fn a_direction_that_the_point_does_not_allow_is_refused_with_one_that_it_does() {
    let text = |tolerance: &str| {
        let goal = format!("tip = [0.66, 0.0, 0.68]\ndirection = [0, 1, 0]\ndirection_tolerance = \"{tolerance}\"");
        with_phases("weightless-a", &phase("turn", &goal))
    };
    let message = refused(&text("2 deg"));
    assert!(message.contains("the tip gets there, but not in this direction"), "{message}");
    let enough = message.split("a `direction_tolerance` of \"").nth(1).unwrap().split('"').next().unwrap();
    // A limb in the plane y = 0 is across the y axis everywhere.
    assert!(enough == "90.0 deg" || enough == "90.1 deg", "{enough}");
    let (_, limb, plan) = planned(&text(enough)).unwrap();
    assert!(off(&limb, &plan, 0, [0.66, 0.0, 0.68]) < 1e-4);
    assert!((tip_after(&limb, &plan, 0).rotation * nalgebra::Vector3::z()).y.abs() < 1e-6);
}

#[test]
fn region_out_of_reach_is_refused() {
    let tables = "[[region]]\nname = \"far\"\ncenter = [3, 0, 1]\nsize = [0.1, 0.1, 0.1]\n".to_owned()
        + &phase("throw", "inside = \"far\"");
    let message = refused(&with_phases("weightless-a", &tables));
    assert!(message.contains("the limb cannot reach into this region"), "{message}");
}
