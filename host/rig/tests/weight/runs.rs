//! What the simulated limb does under load.

use crate::weight::{HANGING, NO_SPREAD, WEIGHTLESS, before, empty, log, longer_m, parsed, repository};

#[test]
fn a_hanging_bundle_is_as_long_as_its_tubes_under_their_share_and_carries_what_it_has_picked() {
    let free = log(&parsed(&(empty() + NO_SPREAD)));
    let scene = parsed(&(HANGING.to_owned() + NO_SPREAD + "[weight]\ncompensated = false\n"));
    let loaded = log(&scene);
    assert_eq!(loaded.faults, []);
    // At the end of `reach` nothing but the connector; picked up from 1.8 s to 2.2 s, put down from 3.0 s to 3.4 s.
    for (time_s, kg) in [(1.39, 0.1), (1.79, 0.1), (2.25, 0.15), (2.55, 0.15), (2.99, 0.15), (3.4, 0.1)] {
        let (a, b) = (before(&free, time_s), before(&loaded, time_s));
        assert_eq!(a.channels, b.channels, "the air knows nothing of the load");
        let lower_m = a.tip_achieved_m.unwrap()[2] - b.tip_achieved_m.unwrap()[2];
        let expected_m = longer_m(&scene, b.channels[0].true_pressure_pa.unwrap(), kg);
        println!("{time_s} s: {:.4} mm lower, {:.4} mm by the tubes", 1e3 * lower_m, 1e3 * expected_m);
        // The springs are those of small loads; the tubes grow softer by the order of the strain, half a percent.
        assert!((lower_m / expected_m - 1.0).abs() < 0.01, "{time_s} s: {lower_m} {expected_m}");
        let stretched = b.modules[0].achieved.unwrap() - a.modules[0].achieved.unwrap();
        // The three pressures are not quite equal, so that the module also bends a little.
        assert!((0.24 * stretched - lower_m).abs() < 1e-6);
    }
}

#[test]
fn weight_that_is_not_simulated_is_not_compensated() {
    let free = log(&repository("single-bending", WEIGHTLESS));
    let off = log(&repository("single-bending", &(WEIGHTLESS.to_owned() + "compensated = false\n")));
    assert_eq!((free.samples, free.shapes), (off.samples, off.shapes));
}

#[test]
fn a_limb_that_cannot_carry_itself_is_said_to_fall_and_has_no_tip_from_there_on() {
    // Straight out, without spacers and air: the reference limb buckles.
    let log = log(&repository("weightless-a", "\n[weight]\ncompensated = false\n"));
    let [fault] = &log.faults[..] else { panic!("{:?}", log.faults) };
    assert_eq!((fault.code, fault.channel), (240, 0xFF));
    assert!(fault.text.contains("shoulder") && fault.text.contains("buckles") && fault.time_s < 0.1, "{fault:?}");
    assert!(log.samples.iter().all(|sample| sample.tip_achieved_m.is_none()));
    assert!(log.samples.iter().all(|sample| sample.modules.iter().all(|module| module.achieved.is_none())));
    let summary = softlimb_rig::report::summary(&log);
    assert!(summary.tip.error_m.is_none() && summary.table().contains("faults  1"));
    assert!(softlimb_rig::report::html(&log).contains("buckles"));
}

/// The scene with a gripper of this time.
fn gripping_in(time: &str) -> String {
    let tool = format!("limb = {{ end_effector = {{ length = 0, mass = 0, gripper_time = \"{time}\" }}, ");
    HANGING.replace("limb = { ", &tool)
}

#[test]
fn jaws_that_close_too_late_leave_the_payload_behind() {
    let more = NO_SPREAD.to_owned() + "[weight]\ncompensated = false\n";
    let free = log(&parsed(&(empty() + NO_SPREAD)));
    let scene = parsed(&(gripping_in("1 s") + &more));
    let log = log(&scene);
    let [fault] = &log.faults[..] else { panic!("{:?}", log.faults) };
    assert_eq!((fault.code, fault.channel, fault.value), (244, 0xFF, 50));
    // The hold of `pick` ends at 2.2 s, when the jaws are 0.4 of their way.
    assert!((2.2..2.3).contains(&fault.time_s) && fault.text.contains("leaves behind"), "{fault:?}");
    let closure = before(&log, 2.2).outputs.gripper_closure.unwrap();
    assert!((0.35..0.4).contains(&closure), "{closure}");
    // The connector alone is carried to the place and away from it.
    for time_s in [2.55, 2.99, 3.4] {
        let (a, b) = (before(&free, time_s), before(&log, time_s));
        let lower_m = a.tip_achieved_m.unwrap()[2] - b.tip_achieved_m.unwrap()[2];
        let expected_m = longer_m(&scene, b.channels[0].true_pressure_pa.unwrap(), 0.1);
        assert!((lower_m / expected_m - 1.0).abs() < 0.01, "{time_s} s: {lower_m} {expected_m}");
    }
}
