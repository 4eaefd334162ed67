//! A limb moved by hand: nothing that keys can do leaves its limits, and a hand that looks at the tip does a scene's task.

#[path = "jog/judge.rs"]
mod judge;

use crate::samples::samples;
use judge::Judge;
use softlimb_limb::Limb;
use softlimb_motion::jog::{Jog, Order, Refusal, Way};
use softlimb_motion::plan;
use softlimb_numerics::Random;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Time between two knots, us.
const PERIOD_US: u64 = 20_000;
/// A target counts as reached within this distance, m.
const WITHIN_M: f64 = 0.01;

fn repository(name: &str) -> Scene {
    scene::load(format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a scene of the repository")
}

fn any_order(random: &mut Random, drives: usize) -> Order {
    let way = Way { axis: random.index(3), with: random.uniform() < 0.6 };
    match random.index(20) {
        0 => Order::Gripper,
        1 => Order::SelectTip,
        2 => Order::SelectDrive(random.index(drives + 1)),
        3 => Order::SelectNext,
        4 => Order::Longer,
        5 => Order::Shorter,
        6 => Order::Faster,
        7 => Order::Slower,
        8 | 9 => Order::Stop,
        10..=13 => Order::Hold(way),
        _ => Order::Go(way),
    }
}

#[test]
fn task_takes_its_load_up_and_puts_it_down() {
    let scene = repository("steering");
    let limb = Limb::new(&scene).unwrap();
    let plan = plan(&scene, &limb).unwrap();
    let mut jog = Jog::new(&scene, &limb, WITHIN_M).unwrap();
    jog.play(&plan);
    let mut loads_kg = vec![jog.carrying().payload_kg];
    for time_us in (0..plan.duration_us()).step_by(PERIOD_US as usize) {
        let knot = jog.knot(time_us);
        assert_eq!((jog.is_gripping(), knot.gripping), [plan.is_gripping_at(time_us); 2].into());
        if loads_kg.last() != Some(&jog.carrying().payload_kg) {
            loads_kg.push(jog.carrying().payload_kg);
        }
    }
    jog.knot(plan.duration_us());
    assert!(jog.task().is_none() && !jog.is_gripping());
    assert_eq!(loads_kg, [0.0, 0.3, 0.0]);
    // It has not ended at rest.
    jog.play(&plan);
    assert!(jog.refusal().is_some() && jog.task().is_none());
}

/// Presses keys at random, between knots at any times, and judges every knot.
fn press_at_random(scene: &Scene, jog: &mut Jog<'_>, judge: &mut Judge<'_>, (seed, orders): (u64, u32), start_us: u64) {
    let limb = Limb::new(scene).unwrap();
    let mut random = Random::new(seed, 0);
    let mut time_us = start_us;
    for _ in 0..orders {
        jog.order(any_order(&mut random, limb.drives().len()));
        for _ in 0..random.index(30) {
            // Knots come at their period, and sooner behind a key.
            time_us += if random.uniform() < 0.2 { 5_000 } else { PERIOD_US };
            let knot = jog.knot(time_us);
            judge.knot(time_us, &knot, jog);
            jog.see(time_us as f64 * 1e-6, knot.tip_m, knot.gripping);
        }
    }
}

#[test]
fn no_key_leaves_the_limits() {
    for (name, full) in
        [("weightless-a", 3000), ("reach-past-post", 3000), ("tip-waypoints", 1000), ("single-bending", 3000)]
    {
        random_keys(name, full);
    }
}

#[test]
fn no_key_leaves_the_limits_under_load() {
    for (name, full) in
        [("pick-and-place-a", 600), ("pick-and-place-b", 400), ("steering", 400), ("loaded/carry-hanging", 300)]
    {
        random_keys(name, full);
    }
}

fn random_keys(name: &str, full: u32) {
    let scene = repository(name);
    let limb = Limb::new(&scene).unwrap();
    for seed in [1, 2] {
        let mut jog = Jog::new(&scene, &limb, WITHIN_M).unwrap();
        let mut judge = Judge::new(name, &scene, &limb);
        press_at_random(&scene, &mut jog, &mut judge, (seed, samples(full)), 0);
        assert!(judge.moved(), "{name}: random keys moved the limb");
    }
}

#[test]
fn no_setpoints_leave_the_limits() {
    for (name, full) in [("weightless-a", 400), ("reach-past-post", 400), ("pick-and-place-a", 60), ("steering", 60)] {
        let scene = repository(name);
        let limb = Limb::new(&scene).unwrap();
        let (mut jog, mut judge) = (Jog::new(&scene, &limb, WITHIN_M).unwrap(), Judge::new(name, &scene, &limb));
        let mut random = Random::new(3, 0);
        let (mut time_us, mut refused) = (0, 0);
        for _ in 0..samples(full) {
            // Now and then beyond an end of the range.
            let any = |drive: softlimb_limb::Drive<'_>, random: &mut Random| {
                let (rest, last) = drive.range();
                rest + (last - rest) * (0.7 * random.uniform() - 0.02)
            };
            let setpoints: Vec<f64> = limb.drives().map(|drive| any(drive, &mut random)).collect();
            jog.lead(&setpoints);
            refused += usize::from(jog.refusal().is_some());
            assert_eq!(jog.refusal().is_some(), !jog.is_moving(), "{name}: {:?}", jog.refusal());
            for _ in 0..random.index(60) {
                time_us += PERIOD_US;
                let knot = jog.knot(time_us);
                judge.knot(time_us, &knot, &jog);
                if !jog.is_moving() && jog.refusal().is_none() {
                    let arrived = knot.setpoints.iter().zip(&setpoints).all(|(a, b)| (a - b).abs() < 1e-8);
                    assert!(arrived, "{name}: {:?} for {setpoints:?}", knot.setpoints);
                }
            }
        }
        println!("{name}: {refused} refused");
        assert!(judge.moved(), "{name}: setpoints moved the limb");
    }
}

#[test]
fn limb_is_not_led_to_what_is_no_setpoint() {
    let scene = repository("weightless-a");
    let limb = Limb::new(&scene).unwrap();
    let mut jog = Jog::new(&scene, &limb, WITHIN_M).unwrap();
    for bad in [vec![], vec![1.0; 2], vec![1.0, f64::NAN, 1.0], vec![1.0, 0.1, f64::INFINITY]] {
        jog.lead(&bad);
        assert!(matches!(jog.refusal(), Some(Refusal::OutOfReach)), "{bad:?}");
    }
    let ends = limb.drives().map(|drive| drive.range()).collect::<Vec<_>>();
    jog.lead(&[ends[0].0, ends[1].1 + 1.0, ends[2].0]);
    assert_eq!(jog.refusal(), Some(&Refusal::Highest("elbow".to_owned())));
    jog.lead(&[ends[0].0, ends[1].0 - 0.1, ends[2].0]);
    assert_eq!(jog.refusal(), Some(&Refusal::AtRest("elbow".to_owned())));
    let plan = plan(&scene, &limb).unwrap();
    jog.play(&plan);
    jog.lead(&[ends[0].0, ends[1].0, ends[2].0]);
    assert_eq!(jog.refusal(), Some(&Refusal::TaskRuns));
}

/// Presses the key of the axis that misses most, or of the next where that one is refused; the gripper's where the tip is there.
fn press_towards(jog: &mut Jog<'_>) {
    let Some(target) = jog.targets().next().filter(|_| !jog.is_moving()) else { return };
    let (gripper, way) = (target.gripper, jog.targets().missing_m());
    if jog.targets().is_there() {
        gripper.into_iter().for_each(|_| jog.order(Order::Gripper));
        return;
    }
    let Some(way) = way else { return };
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| way[*b].abs().total_cmp(&way[*a].abs()));
    let keys = axes.into_iter().filter(|axis| way[*axis].abs() > 1e-3).map(|axis| Way { axis, with: way[axis] > 0.0 });
    for way in keys {
        jog.order(Order::Go(way));
        if jog.refusal().is_none() {
            return;
        }
    }
    panic!("{:?} at {:?}", jog.refusal(), jog.targets().next());
}

/// Does the scene's task by steps of 5 mm along the axis that misses most; the time, us.
fn do_the_task(jog: &mut Jog<'_>, judge: &mut Judge<'_>, (until, start_us): (usize, u64)) -> u64 {
    let mut time_us = start_us;
    while jog.targets().met() < until {
        press_towards(jog);
        time_us += PERIOD_US;
        let knot = jog.knot(time_us);
        judge.knot(time_us, &knot, jog);
        jog.see(time_us as f64 * 1e-6, knot.tip_m, knot.gripping);
        assert!(time_us < start_us + 300_000_000, "{:?}", jog.targets().attempts());
    }
    time_us
}

#[test]
fn hand_that_looks_at_the_tip_picks_and_places() {
    let scene = repository("pick-and-place-a");
    let limb = Limb::new(&scene).unwrap();
    let mut jog = Jog::new(&scene, &limb, WITHIN_M).unwrap();
    let mut judge = Judge::new("pick-and-place-a", &scene, &limb);
    let picked_us = do_the_task(&mut jog, &mut judge, (1, 0));
    assert!(jog.is_gripping() && jog.carrying().payload_kg == 0.6, "the bottle is taken");
    let placed_us = do_the_task(&mut jog, &mut judge, (4, picked_us));
    for attempt in jog.targets().attempts() {
        assert!(attempt.time_s.is_some() && attempt.least_m <= WITHIN_M, "{attempt:?}");
    }
    // With the bottle in the gripper.
    press_at_random(&scene, &mut jog, &mut judge, (7, samples(400)), placed_us);
}

/// Presses a key and waits for the end of the step; the setpoints.
fn pressed(jog: &mut Jog<'_>, order: Order, time_us: &mut u64) -> Vec<f64> {
    jog.order(order);
    loop {
        *time_us += PERIOD_US;
        let knot = jog.knot(*time_us);
        if !jog.is_moving() {
            return knot.setpoints;
        }
    }
}

#[test]
fn keys_of_a_module_raise_and_lower_its_pressure() {
    for name in ["weightless-a", "weightless-b", "loaded/carry-hanging"] {
        let scene = repository(name);
        let limb = Limb::new(&scene).unwrap();
        let rest: Vec<f64> = limb.drives().map(|drive| drive.measure(&drive.actuator.rest())).collect();
        for drive in limb.drives() {
            let mut jog = Jog::new(&scene, &limb, WITHIN_M).unwrap();
            let (mut time_us, index) = (0, drive.index);
            let way = |with| Order::Go(Way { axis: 0, with });
            jog.order(Order::SelectDrive(index));
            jog.order(way(false));
            assert!(jog.refusal().is_some(), "{name}: {} has no pressure to lower", drive.name());
            let raised = pressed(&mut jog, way(true), &mut time_us);
            let pressure_pa = drive.state_at(raised[index]).unwrap().pressure_pa;
            assert!(pressure_pa > 10.0, "{name}: {} at {pressure_pa} Pa", drive.name());
            // 5 mm or deg, by hand.
            let step = match drive.kind.display_unit() {
                "deg" => 5f64.to_radians(),
                _ => 5e-3 / drive.length_m(),
            };
            assert!(((raised[index] - rest[index]).abs() - step).abs() < 1e-9, "{name}: {raised:?}");
            let lowered = pressed(&mut jog, way(false), &mut time_us);
            assert!(lowered.iter().zip(&rest).all(|(a, b)| (a - b).abs() < 1e-9), "{name}: {lowered:?}");
        }
    }
}
