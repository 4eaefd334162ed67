//! Plans past obstacles, judged by samples of the plan.

use super::common::{planned, refused, repository, sampled_clearance, tip_after, with_phases};

/// What the planner does straight: the tip's way without the post, which goes right through it.
#[test]
fn the_limb_goes_around_a_post_that_it_would_hit_and_keeps_clear_all_the_way() {
    let text = repository("reach-past-post").source_text().to_owned();
    let (scene, limb, plan) = planned(&text).unwrap();
    let clearance = sampled_clearance(&scene, &limb, &plan);
    assert!(clearance >= 5e-3, "{clearance}");
    let least = plan.phases.iter().filter_map(|phase| phase.nearest).map(|near| near.distance_m).fold(1.0, f64::min);
    assert!((clearance - least).abs() < 5e-4, "samples say {clearance}, the plan {least}");
    assert!(plan.phases[1].via_points > 0, "straight it would hit");
    let free = with_phases("reach-past-post", &text[text.find("[[region]]").unwrap()..text.find("[limits]").unwrap()]);
    let (_, free_limb, free_plan) = planned(&free).unwrap();
    assert!(sampled_clearance(&scene, &free_limb, &free_plan) < 0.0);
    assert!(free_plan.phases.iter().all(|phase| phase.nearest.is_none() && phase.via_points == 0));
}

/// Way-point, direction and region, from the poses at the ends of the moves.
#[test]
fn way_point_direction_and_region_are_kept() {
    let (scene, limb, plan) = planned(repository("reach-past-post").source_text()).unwrap();
    let around = tip_after(&limb, &plan, 1);
    let point = nalgebra::Vector3::new(0.719, -0.032, 0.780);
    assert!((around.translation.vector - point).norm() < 1e-4);
    let axis = around.rotation * nalgebra::Vector3::z();
    let direction = nalgebra::Vector3::new(1.0, -0.25, -1.0).normalize();
    assert!(axis.dot(&direction) >= 10.0_f64.to_radians().cos());
    let inside = tip_after(&limb, &plan, 2).translation.vector - nalgebra::Vector3::new(0.62, 0.0, 0.75);
    assert!(inside.x.abs() <= 0.05 && inside.y.abs() <= 0.05 && inside.z.abs() <= 0.03, "{inside}");
    assert_eq!(scene.regions().len(), 1);
}

/// Two posts with a gap through which the tool just passes.
#[test]
fn a_narrow_passage_is_found() {
    let post = |name: &str, y: f64| {
        format!(
            "[[obstacle]]\nname = \"{name}\"\nshape = \"capsule\"\nfrom = [0.72, {y}, 0.4]\nto = [0.72, {y}, 1.6]\nradius = \"20 mm\"\n"
        )
    };
    let phases = |gap: f64| {
        let posts = post("left", 0.5 * gap) + &post("right", -0.5 * gap);
        let there = "[[phase]]\nname = \"there\"\ntip = [0.83, 0.0, 1.05]\n";
        let back = "[[phase]]\nname = \"back\"\ntargets = { shoulder = { axial_stretch = 1 }, elbow = { bend_angle = \"40 deg\" }, wrist = { bend_angle = 0 } }\n";
        with_phases("reach-past-post", &format!("{posts}{back}{there}"))
            .replace("clearance = \"5 mm\"", "clearance = \"1 mm\"")
    };
    // The bending bundle is 96 mm thick, the posts 40 mm, and twice 1 mm is kept: 138 mm.
    let (scene, limb, plan) = planned(&phases(0.141)).unwrap();
    let clearance = sampled_clearance(&scene, &limb, &plan);
    assert!(clearance >= 1e-3, "{clearance}");
    assert!(refused(&phases(0.136)).contains("too near"));
}

const BALL: &str =
    "[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = [0.66, 0.0, 0.68]\nradius = \"40 mm\"\n";
const INTO: [f64; 3] = [0.66, 0.0, 0.68];

/// A bar across the plane that the limb moves in.
fn bar(x: f64, z: f64) -> String {
    format!(
        "[[obstacle]]\nname = \"bar\"\nshape = \"capsule\"\nfrom = [{x}, -0.4, {z}]\nto = [{x}, 0.4, {z}]\nradius = \"20 mm\"\n"
    )
}

fn going_to(obstacles: &str, tip_m: [f64; 3]) -> String {
    with_phases(
        "weightless-a",
        &format!("{obstacles}[[phase]]\nname = \"into\"\nduration = \"4 s\"\ntip = {tip_m:?}\n"),
    )
}

/// The point that a message gives behind some words, m.
fn point_after(message: &str, words: &str) -> nalgebra::Vector3<f64> {
    let rest = message.split(words).nth(1).unwrap_or_else(|| panic!("no {words:?}: {message}"));
    let numbers = rest.split(']').next().unwrap().split(['[', '"', ',']).filter_map(|part| part.strip_suffix(" mm"));
    let point: Vec<f64> = numbers.map(|number| number.trim().parse::<f64>().unwrap() * 1e-3).collect();
    nalgebra::Vector3::from_row_slice(&point)
}

/// What is offered can be planned as it is written, to 0.1 mm, and keeps clear; the planner reaches what is written to 0.1 mm.
fn assert_offer(obstacles: &str, offer: nalgebra::Vector3<f64>) {
    let (scene, limb, plan) = planned(&going_to(obstacles, offer.into())).unwrap();
    assert!((tip_after(&limb, &plan, 0).translation.vector - offer).norm() < 2e-4);
    assert!(sampled_clearance(&scene, &limb, &plan) > 0.0);
}

/// The way-point is in the middle of a ball of 40 mm; the tool is a ball of 20 mm about the tip. The first point found on the ball is behind
/// it.
#[test]
fn a_way_point_in_an_obstacle_is_refused_with_the_nearest_that_is_clear() {
    let message = refused(&going_to(BALL, INTO));
    assert!(message.contains("the limb cannot be here and clear of `ball`"), "{message}");
    assert!(message.contains("tip = [0.66"), "the line is shown: {message}");
    let tip = point_after(&message, "the nearest point that is clear is ");
    // Written to 0.1 mm.
    assert!(((tip - nalgebra::Vector3::from(INTO)).norm() - 0.06).abs() < 1e-3, "{tip}");
    assert!(tip.y.abs() < 1e-3, "the limb moves in a plane: {tip}");
    assert_offer(BALL, tip);
}

/// A bar before the ball: the points on the ball are clear, but all behind the bar.
#[test]
fn a_point_without_a_way_is_offered_together_with_one_that_has_a_way() {
    let obstacles = BALL.to_owned() + &bar(0.60, 0.90);
    let message = refused(&going_to(&obstacles, INTO));
    let behind = point_after(&message, "the nearest point that is clear is ");
    let before = point_after(&message, "no way there was found; the nearest with a way is ");
    let far = |point: nalgebra::Vector3<f64>| (point - nalgebra::Vector3::from(INTO)).norm();
    assert!((far(behind) - 0.06).abs() < 1e-3 && far(before) > far(behind) + 0.01, "{behind} {before}");
    assert_offer(&obstacles, before);
}

/// Nothing is in the way-point, and nothing leads there.
#[test]
fn a_clear_goal_without_a_way_is_refused_with_how_near_a_way_leads() {
    let obstacles = bar(0.75, 0.92);
    let message = refused(&going_to(&obstacles, INTO));
    assert!(message.contains("the limb finds no way to this goal that keeps clear"), "{message}");
    let offer = point_after(&message, "the nearest point that a way was found to is ");
    // The straight limb of 0.815 m begins much farther away.
    let far = (offer - nalgebra::Vector3::from(INTO)).norm();
    assert!(far > 1e-3 && far < 0.4, "{offer}");
    assert_offer(&obstacles, offer);
}

#[test]
fn targets_that_end_in_an_obstacle_are_refused_at_their_line() {
    let tables = "[[obstacle]]\nname = \"floor\"\nshape = \"box\"\ncenter = [0.5, 0, 0.7]\nsize = [2, 2, 0.02]\n\
                  [[phase]]\nname = \"down\"\ntargets = { elbow = { bend_angle = \"80 deg\" } }\n";
    let message = refused(&with_phases("weightless-a", tables));
    assert!(message.contains("at this goal the limb is too near `floor`"), "{message}");
    assert!(message.contains("bend_angle = \"80 deg\"") && message.contains("% far"), "{message}");
}
