//! Inverse problems with several answers: the rule, ranges of pressure, all answers; and numbers that a scalar does not hold.

use crate::common::*;
use fra_model::*;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

const VACUUM_PA: f64 = 101_325.0;
/// Pressures of a scan, in shear moduli: from the first to the last in equal ratios.
const SCAN: (f64, f64, i32) = (1e-4, 30.0, 400);

fn wound_tubes(count: u32) -> Vec<(ActuatorParameters<f64>, f64, f64)> {
    let placement = prop::sample::select(vec![Placement::Sheet, Placement::Layer, Placement::Smeared]);
    let families = prop::sample::select(vec![Families::One, Families::Two]);
    let strategy = (
        (3.5..6.0_f64, 1.05..3.0_f64, 0.0..90.0_f64),
        (placement, families, -0.5..4.0_f64),
        (-0.35..0.6_f64, 0.0..1.0_f64),
    );
    let tubes = strategy.prop_map(|((log_mu, ratio, angle_deg), (placement, families, log_ratio), (share, aim))| {
        let mu = 10.0_f64.powf(log_mu);
        let bare = tube(Motion::Extension, 6.0, 6.0 * ratio, neo_hookean(mu));
        let thickness_mm = 0.6 * (ratio - 1.0);
        let p = wound(bare, angle_deg, families, mu * 10.0_f64.powf(log_ratio), placement, thickness_mm);
        (p, share * mu * ratio.ln(), aim)
    });
    let seed = TestRng::from_seed(RngAlgorithm::ChaCha, &[18; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), seed);
    (0..count).map(|_| tubes.new_tree(&mut runner).expect("a tube").current()).collect()
}

type Measure = fn(&State<f64>) -> f64;

/// A target that the tube has at a pressure, and the measure of it.
fn target(p: &ActuatorParameters<f64>, state: &State<f64>, aim: f64) -> (Target<f64>, Measure) {
    let twists = p.fiber.is_some_and(|fiber| fiber.families == Families::One);
    match aim {
        aim if aim < 0.3 => (Target::OuterRadius(state.outer_radius_m), |s| s.outer_radius_m),
        aim if aim < 0.6 => (Target::InnerRadius(state.inner_radius_m), |s| s.inner_radius_m),
        aim if aim < 0.8 && twists => (Target::Twist(state.twist_rad), |s| s.twist_rad),
        _ => (Target::AxialStretch(state.axial_stretch), |s| s.axial_stretch),
    }
}

/// A target with the pressure that it was made by.
struct Question {
    p: ActuatorParameters<f64>,
    actuator: Actuator<f64>,
    pressure_pa: f64,
    solution: Solution<f64>,
    target: Target<f64>,
    measure: Measure,
}

/// Questions of the tubes that have a shape at their pressure.
fn questions(count: u32) -> impl Iterator<Item = Question> {
    wound_tubes(count).into_iter().filter_map(|(p, pressure_pa, aim)| {
        let actuator = Actuator::new(&p).expect("valid");
        let solution = actuator.forward(pressure_pa, &Load::none()).expect("finite");
        let (target, measure) = target(&p, &solution.state, aim);
        (solution.status == Status::Solved).then_some(Question { p, actuator, pressure_pa, solution, target, measure })
    })
}

/// Pressures of a scan upwards between which a measure passes a value, by forward solves alone.
fn crossings(actuator: &Actuator<f64>, measure: Measure, value: f64) -> Vec<(f64, f64)> {
    let mu = actuator.parameters().material.shear_modulus_pa();
    let (first, last, steps) = SCAN;
    let mut before = (0.0, measure(&actuator.rest()) - value);
    let mut found = vec![];
    for step in 0..=steps {
        let pressure_pa = mu * first * (last / first).powf(f64::from(step) / f64::from(steps));
        let solution = actuator.forward(pressure_pa, &Load::none()).expect("finite");
        if solution.status != Status::Solved {
            break;
        }
        let off = measure(&solution.state) - value;
        if (before.1 < 0.0 && off > 0.0) || (before.1 > 0.0 && off < 0.0) {
            found.push((before.0, pressure_pa));
        }
        before = (pressure_pa, off);
    }
    found
}

/// The first pressure that a scan by forward solves crosses is the answer; a vacuum is one only where the scan finds no pressure.
#[test]
fn vacuum_is_an_answer_only_where_no_pressure_is() {
    let (mut vacuums, mut pressures, mut several) = (0_u32, 0_u32, 0_u32);
    for Question { p, actuator, pressure_pa, solution, target, measure } in questions(samples(600)) {
        let answer = actuator.inverse(target, &Load::none()).expect("a target");
        let scan = crossings(&actuator, measure, measure(&solution.state));
        let beyond = pressure_pa < -VACUUM_PA && scan.is_empty();
        if answer.status != Status::Solved {
            assert!(beyond || pressure_pa == 0.0, "{:?} for {pressure_pa} Pa: {p:?}", answer.status);
            continue;
        }
        let found_pa = answer.state.pressure_pa;
        assert!(found_pa >= -VACUUM_PA, "{found_pa} Pa is less than nothing: {p:?}");
        if let Some(&(low, high)) = scan.first() {
            pressures += 1;
            several += u32::from(scan.len() > 1);
            // The scan may step over a pair of answers, never past the first by more than a step.
            assert!(found_pa >= 0.0 && found_pa <= high, "{found_pa} Pa, the scan {low} to {high}: {p:?}");
        } else {
            vacuums += u32::from(found_pa < 0.0);
        }
        assert!(relative(measure(&answer.state), measure(&solution.state)) < 1e-9, "{p:?}");
    }
    assert!(vacuums >= samples(60) && pressures >= samples(200) && several >= 1, "{vacuums} {pressures} {several}");
}

/// All answers contain the pressure that made the target and every crossing of a scan; a range cuts them, and its first is the answer.
#[test]
fn all_answers_are_listed_and_a_range_chooses_among_them() {
    let mut several = 0_u32;
    for Question { p, actuator, pressure_pa, solution, target, measure } in questions(samples(600)) {
        let mu = p.material.shear_modulus_pa();
        let list = |range: &PressureRange<f64>| {
            let mut found = vec![];
            let complete = actuator
                .inverse_all(range, target, &Load::none(), &mut |solution| found.push(*solution))
                .expect("valid");
            assert!(complete, "{p:?}");
            found
        };
        let wide = PressureRange { least_pa: pressure_pa.min(0.0) - mu, most_pa: SCAN.1 * mu };
        let all = list(&wide);
        let pressures: Vec<f64> = all.iter().map(|solution| solution.state.pressure_pa).collect();
        // Next to a turning point two answers lie within the rounding of one.
        let near =
            |wanted: f64| pressures.iter().any(|found| (found - wanted).abs() <= 1e-5 * (wanted.abs() + 1e-3 * mu));
        assert!(near(pressure_pa), "{pressure_pa} is not among {pressures:?}: {p:?}");
        for (low, high) in crossings(&actuator, measure, measure(&solution.state)) {
            assert!(
                pressures.iter().any(|found| *found >= low && *found <= high),
                "{low} to {high}: {pressures:?}: {p:?}"
            );
        }
        for solution in &all {
            let again = actuator.forward(solution.state.pressure_pa, &Load::none()).expect("finite");
            assert!(relative(measure(&again.state), measure(&solution.state)) < 1e-6, "{p:?}");
        }
        let first = actuator.inverse_within(&wide, target, &Load::none()).expect("valid");
        assert_eq!(Some(first.state.pressure_pa), pressures.first().copied(), "{p:?}");
        several += u32::from(pressures.len() > 1);
        // A range that starts behind the first answer has the second for its first, and one in between has none.
        let up: Vec<f64> = pressures.iter().copied().filter(|pressure| *pressure > 0.0).collect();
        if let [low, high, ..] = up[..]
            && high > 1.01 * low
        {
            let behind = PressureRange { least_pa: low + 0.5 * (high - low), ..wide };
            let second = actuator.inverse_within(&behind, target, &Load::none()).expect("valid");
            assert!(relative(second.state.pressure_pa, high) < 1e-9, "{} {high}: {p:?}", second.state.pressure_pa);
            let between = PressureRange { least_pa: low + 0.1 * (high - low), most_pa: high - 0.1 * (high - low) };
            let none = actuator.inverse_within(&between, target, &Load::none()).expect("valid");
            assert_eq!(none.status, Status::NoSolution, "{p:?}");
        }
    }
    assert!(several >= samples(30), "{several}");
}

#[test]
fn bend_outside_the_range_has_no_answer() {
    let actuator = Actuator::new(&tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6))).expect("valid");
    let half_turn = Target::BendAngle(core::f64::consts::PI);
    let pressure_pa = actuator.inverse(half_turn, &Load::none()).expect("valid").state.pressure_pa;
    for (share, status) in [(0.99, Status::NoSolution), (1.01, Status::Solved)] {
        let range = PressureRange { least_pa: 0.0, most_pa: share * pressure_pa };
        assert_eq!(actuator.inverse_within(&range, half_turn, &Load::none()).expect("valid").status, status);
    }
    // A moment that bends the tube farther than the target must be held back by a vacuum.
    let pulled = Load { force_n: 0.0, torque_nm: 0.05 };
    let held = actuator.inverse(Target::BendAngle(0.1), &pulled).expect("valid");
    assert!(held.status == Status::Solved && held.state.pressure_pa < 0.0);
    let range = PressureRange { least_pa: 0.0, most_pa: 1e6 };
    let refused = actuator.inverse_within(&range, Target::BendAngle(0.1), &pulled).expect("valid");
    assert_eq!(refused.status, Status::NoSolution);
}

#[test]
fn range_that_is_none_is_refused() {
    let actuator = Actuator::new(&tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6))).expect("valid");
    for (least_pa, most_pa) in [(1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (f64::NEG_INFINITY, 0.0)] {
        let range = PressureRange { least_pa, most_pa };
        let error = actuator.inverse_within(&range, Target::AxialStretch(1.1), &Load::none()).expect_err("no range");
        assert!(error.field.starts_with("pressure_range"), "{error}");
        assert!(actuator.inverse_all(&range, Target::AxialStretch(1.1), &Load::none(), &mut |_| ()).is_err());
    }
}

/// Two mirrored families are odd in the torque, so a tiny one twists by its share of a small one. The small one's twist follows from the
/// stiffness of the blocked tube, which another solver computes.
fn tiny_torques_twist<T: Precision>(exact: impl Fn(f64) -> T + Copy, value: impl Fn(T) -> f64, torques_nm: &[f64]) {
    for placement in [Placement::Sheet, Placement::Layer, Placement::Smeared] {
        for (modulus_pa, pressure_pa) in [(1e6, 0.0), (1e6, 2e4), (3e8, 2e4), (3e8, -1e4)] {
            let bare = tube(Motion::Extension, 6.0, 8.0, neo_hookean(2e5));
            let p = wound(bare, 20.0, Families::Two, modulus_pa, placement, 0.2).map(|number| value(exact(number)));
            let blocked = {
                let actuator = Actuator::new(&p).expect("valid");
                let free = actuator.forward(pressure_pa, &Load::none()).expect("finite").state;
                actuator.blocked(pressure_pa, free.axial_stretch, 0.0).expect("finite").stiffness[1][1]
            };
            let actuator = Actuator::new(&p.map(exact)).expect("valid");
            for &torque_nm in torques_nm {
                let load = Load { force_n: exact(0.0), torque_nm: exact(torque_nm) };
                let solution = actuator.forward(exact(pressure_pa), &load).expect("finite");
                assert_eq!(solution.status, Status::Solved, "{placement:?} {modulus_pa} {torque_nm}");
                let off = relative(value(solution.state.twist_rad), torque_nm / blocked);
                let bar = 20.0 * value(T::default_epsilon()) + 1e-8;
                assert!(off < bar, "{placement:?}, {modulus_pa} Pa, {pressure_pa} Pa, {torque_nm} N m: off by {off:e}");
            }
        }
    }
}

#[test]
fn tiny_torques_twist_two_families_by_their_share() {
    tiny_torques_twist::<f64>(|v| v, |v| v, &[1e-9, 1e-15, -1e-18, 1e-24, 1e-31, 1e-33, -1e-40, 1e-100, 1e-250]);
    tiny_torques_twist::<f32>(|v| v as f32, f64::from, &[1e-9, 1e-12, -1e-15, 1e-16, 1e-17, -1e-20, 1e-25, 1e-30]);
}

/// Sizes whose volume the scalar does not hold have no answer, rather than one that is infinite, zero or no number.
#[test]
fn numbers_that_overflow_are_no_answers() {
    fn ask<T: Precision>(exact: impl Fn(f64) -> T + Copy, scales: &[f64]) {
        for motion in Motion::ALL {
            for &scale in scales {
                let p = tube(motion, 6.0, 8.0, neo_hookean(2e5));
                let p = ActuatorParameters {
                    inner_radius_m: p.inner_radius_m * scale,
                    outer_radius_m: p.outer_radius_m * scale,
                    ..p
                };
                let Ok(actuator) = Actuator::new(&p.map(exact)) else { continue };
                let load = Load { force_n: exact(0.0), torque_nm: exact(1e-3) };
                for load in [Load::none(), load] {
                    let forward = actuator.forward(exact(1e4), &load).expect("finite");
                    assert_ne!(forward.status, Status::Solved, "{motion:?} {scale:e}: {forward:?}");
                    let wanted = if motion == Motion::Bending { Target::BendAngle } else { Target::AxialStretch };
                    let inverse = actuator.inverse(wanted(exact(1.001)), &load).expect("a target");
                    assert_ne!(inverse.status, Status::Solved, "{motion:?} {scale:e}: {inverse:?}");
                }
                let once = Actuator::forward_once(&p.map(exact), exact(1e4), &Load::none()).expect("finite");
                assert_ne!(once.status, Status::Solved, "{motion:?} {scale:e}: {once:?}");
            }
        }
    }
    ask::<f64>(|v| v, &[1e-170, 1e160]);
    ask::<f32>(|v| v as f32, &[1e-25, 1e22]);
}
