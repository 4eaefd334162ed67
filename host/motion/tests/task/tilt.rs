//! Tilt of what the tip holds, judged by samples of the plan.

use nalgebra::Vector3;

use super::common::{planned, refused, repository, with_phases};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb};
use softlimb_motion::{Plan, carried, payload_kg};
use softlimb_scene::Scene;

/// It may tilt as it likes.
const FREE: &str = "tilt_max = \"180 deg\"";

/// A cup that is taken at one point and carried to a goal.
fn cup(key: &str, goal: &str) -> String {
    let object = format!(
        "[[object]]\nname = \"cup\"\nradius = \"20 mm\"\nheight = \"60 mm\"\ngrasp = \"50 mm\"\nmass = \"0 kg\"\n{key}\n"
    );
    let region = "[[region]]\nname = \"shelf\"\ncenter = [0.68, -0.1, 0.9]\nsize = [0.05, 0.3, 0.3]\n";
    let phase =
        |name: &str, keys: &str| format!("[[phase]]\nname = \"{name}\"\nhold = \"0.5 s\"\nobject = \"cup\"\n{keys}\n");
    let phases = phase("take", "tip = [0.83, 0, 1.05]\ngripper = \"close\"") + &phase("carry", goal);
    with_phases("reach-past-post", &(object + region + &phases))
}

/// Largest tilt of the cup from the end of the move of `take` to that of `carry`, deg, by the kinematics.
fn sampled_deg(limb: &Limb, plan: &Plan) -> f64 {
    let end_us = |phase: usize| plan.phases[phase].start_us + plan.phases[phase].move_us;
    let turn = |time_us: u64| limb.tip_pose(&plan.states_at(time_us as f64)).rotation;
    let axis = turn(end_us(0)).inverse() * Vector3::z();
    let tilt = |time_us: u64| (turn(time_us) * axis).angle(&Vector3::z()).to_degrees();
    (end_us(0)..=end_us(1)).step_by(5_000).map(tilt).fold(0.0, f64::max)
}

#[test]
fn held_object_stays_within_its_tilt_all_the_way() {
    let goal = "inside = \"shelf\"";
    let (_, limb, free) = planned(&cup(FREE, goal)).unwrap();
    let free_deg = sampled_deg(&limb, &free);
    let most_deg = (0.8 * free_deg).floor();
    assert!(free.phases[0].tilt_rad.is_some_and(|rad| rad < 1e-3) && most_deg > 20.0, "{free_deg}");
    let key = format!("tilt_max = \"{most_deg} deg\"");
    let (scene, limb, plan) = planned(&cup(&key, goal)).unwrap_or_else(|error| panic!("{error}"));
    let tilt_deg = sampled_deg(&limb, &plan);
    println!("{free_deg:.1} deg free, {tilt_deg:.1} of {most_deg} deg");
    assert!(tilt_deg <= most_deg, "{tilt_deg}");
    // The plan says what samples say.
    let said = plan.phases.iter().filter_map(|phase| phase.tilt_rad).fold(0.0, f64::max).to_degrees();
    assert!((said - tilt_deg).abs() < 0.1, "{said} {tilt_deg}");
    let end_us = plan.phases[1].start_us + plan.phases[1].move_us;
    let tip_m = Vector3::from(plan.tip_m(&limb, end_us as f64));
    assert!(scene.regions()[0].shape.distance(&tip_m).distance_m <= 1e-4, "{tip_m}");
}

#[test]
fn tilt_that_cannot_be_kept_is_refused_with_the_least_that_was_found() {
    // Three drives have one pose for a point.
    let (_, limb, free) = planned(&cup(FREE, "tip = [0.719, -0.032, 0.780]")).unwrap();
    let end_us = |phase: usize| free.phases[phase].start_us + free.phases[phase].move_us;
    let [taken, there] = [0, 1].map(|phase| limb.tip_pose(&free.states_at(end_us(phase) as f64)).rotation);
    let tilt_deg = (there * taken.inverse() * Vector3::z()).angle(&Vector3::z()).to_degrees();
    let said = refused(&cup("tilt_max = \"3 deg\"", "tip = [0.719, -0.032, 0.780]"));
    assert!(said.contains("its object tilts too much") && said.contains("its `tilt_max` is 3.0 deg"), "{said}");
    assert!(said.contains("tip = [0.719, -0.032, 0.780]"), "at the goal: {said}");
    assert!(said.contains(&format!("`cup` would tilt by {tilt_deg:.1} deg")), "{tilt_deg}: {said}");
}

/// Targets leave no choice: the plan is refused with the tilt that closed forms give.
#[test]
fn targets_that_tilt_too_much_are_refused() {
    let object = "[[object]]\nname = \"cup\"\nradius = \"20 mm\"\nheight = \"60 mm\"\ngrasp = \"50 mm\"\nmass = \"0 kg\"\ntilt_max = \"20 deg\"\n";
    let phase = |name: &str, bend: &str, more: &str| {
        format!(
            "[[phase]]\nname = \"{name}\"\nobject = \"cup\"\n{more}targets = {{ shoulder = {{ axial_stretch = 1 }}, elbow = {{ bend_angle = \"{bend}\" }}, wrist = {{ bend_angle = 0 }} }}\n"
        )
    };
    let text = |bend: &str| {
        let phases = phase("take", "30 deg", "gripper = \"close\"\n") + &phase("turn", bend, "");
        with_phases("reach-past-post", &(object.to_owned() + &phases))
    };
    // The elbow bends in the vertical plane: the cup tilts by the change of its angle.
    let said = refused(&text("55 deg"));
    assert!(said.contains("`cup` would tilt by 25.0 deg") && said.contains("bend_angle = \"55 deg\""), "{said}");
    let (_, _, plan) = planned(&text("49 deg")).unwrap();
    assert!((plan.phases[1].tilt_rad.unwrap().to_degrees() - 19.0).abs() < 0.1);
}

/// Largest tilt of the bottle from the grasp to the release, deg, by finer rods than the planner's.
fn sagging_deg(scene: &Scene, limb: &Limb, plan: &Plan) -> f64 {
    let carried = carried(scene.phases());
    let (mut axis, mut most_deg) = (None, 0.0_f64);
    for phase in 0..plan.phases.len() {
        let planned = &plan.phases[phase];
        let (begin_us, end_us) = (planned.start_us, planned.start_us + planned.move_us);
        for time_us in (begin_us..end_us).step_by(500_000).chain([end_us]) {
            let holds = if time_us < end_us { carried[phase].moved.object } else { carried[phase].held.object };
            if holds.is_none() {
                continue;
            }
            let states = plan.states_at(time_us as f64);
            let drives = limb.drives().zip(&states);
            let channels: Vec<f64> =
                drives.flat_map(|(drive, state)| vec![state.pressure_pa.max(0.0); drive.channels.len()]).collect();
            let bays: Vec<usize> = scene.modules().iter().map(|module| usize::from(module.spacers) + 1).collect();
            let load = Load { payload_kg: payload_kg(&carried, &plan.phases, time_us), ..Load::default() };
            let loaded = LoadedLimb::new(scene, limb, &channels, &bays, &load).expect("a bundle");
            let turn = loaded.settle(Fidelity::Fourfold, None).expect("it stands").shape.tip().rotation;
            let axis = *axis.get_or_insert_with(|| turn.inverse() * Vector3::z());
            most_deg = most_deg.max((turn * axis).angle(&Vector3::z()).to_degrees());
        }
    }
    most_deg
}

#[test]
fn sagging_limb_keeps_its_bottle_within_the_tilt() {
    let text = repository("pick-and-place-a").source_text().to_owned();
    let kept = |line: &&str| !line.starts_with("direction") && !line.starts_with("tilt_max");
    let bare: String = text.lines().filter(kept).map(|line| format!("{line}\n")).collect();
    let with = |tilt: &str| bare.replacen("grasp = \"120 mm\"", &format!("{tilt}grasp = \"120 mm\""), 1);
    let (scene, limb, plan) = planned(&with(&format!("{FREE}\n"))).unwrap();
    let free_deg = sagging_deg(&scene, &limb, &plan);
    // 35 deg is the default.
    let (scene, limb, plan) = planned(&bare).unwrap();
    let tilt_deg = sagging_deg(&scene, &limb, &plan);
    println!("{free_deg:.1} deg free, {tilt_deg:.1} kept");
    assert!(free_deg > 35.0 && tilt_deg <= 35.0, "{free_deg} {tilt_deg}");
    let said = refused(&with("tilt_max = \"20 deg\"\n"));
    assert!(said.contains("`bottle` would tilt by") && said.contains("its `tilt_max` is 20.0 deg"), "{said}");
}
