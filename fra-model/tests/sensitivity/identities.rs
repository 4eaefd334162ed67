//! What holds for the derivatives of every equilibrium: Maxwell's relations and homogeneity.

use std::f64::consts::FRAC_PI_2;

use super::*;

/// All inputs that are lengths, with the loads' powers of a length; then moduli and loads.
const LENGTHS: [(Parameter, f64); 7] = [
    (Parameter::InnerRadius, 1.0),
    (Parameter::OuterRadius, 1.0),
    (Parameter::Length, 1.0),
    (Parameter::SheetThickness, 1.0),
    (Parameter::WindingRadius, 1.0),
    (Parameter::Force, 2.0),
    (Parameter::Torque, 3.0),
];
const STRESSES: [(Parameter, f64); 8] = [
    (Parameter::ShearModulus, 1.0),
    (Parameter::YeohC1, 1.0),
    (Parameter::YeohC2, 1.0),
    (Parameter::YeohC3, 1.0),
    (Parameter::FiberModulus, 1.0),
    (Parameter::Pressure, 1.0),
    (Parameter::Force, 1.0),
    (Parameter::Torque, 1.0),
];

fn cases() -> Vec<Case> {
    [straight_cases(), bent_cases(), helical_cases()].into_iter().flatten().collect()
}

/// `P dV + N dl + M dPhi` (on a bend `M dphi`) is the change of an energy, so `V`, `l` and the angle are its derivatives by the
/// loads and their cross derivatives agree.
#[test]
fn cross_derivatives_by_pressure_force_and_torque_agree() {
    for case in cases() {
        let [by_pressure, by_force, by_torque] =
            [Parameter::Pressure, Parameter::Force, Parameter::Torque].map(|parameter| case.by(parameter));
        let length = |s: &State<f64>| s.axial_stretch * case.p.length_m;
        let angle = |s: &State<f64>| s.twist_rad + s.bend_angle_rad;
        for (a, b, own) in [
            (length(&by_pressure), by_force.volume_m3, by_pressure.volume_m3 * length(&by_force)),
            (angle(&by_pressure), by_torque.volume_m3, by_pressure.volume_m3 * angle(&by_torque)),
            (length(&by_torque), angle(&by_force), length(&by_force) * angle(&by_torque)),
        ] {
            // Relative to the derivatives of each by its own load, which bound the cross derivatives of a stable state.
            close(a, b, 1e-12 * own.sqrt(), (&case.p, case.load));
            assert!(a * a <= own * (1.0 + 1e-12), "not stable: {:?}", case.p);
        }
    }
}

/// What a change of all inputs in proportion does, `sum power p ds/dp`.
fn scaled(case: &Case, inputs: &[(Parameter, f64)], by: impl Fn(Parameter) -> State<f64>) -> (State<f64>, State<f64>) {
    let there: Vec<_> = case.actuator.inputs().collect();
    let zero = State::combine([&case.state], |_| 0.0);
    inputs.iter().filter(|(parameter, _)| there.contains(parameter)).fold(
        (zero, zero),
        |(sum, size), (parameter, power)| {
            let (change, share) = (by(*parameter), power * case.value(*parameter));
            let sum = State::combine([&sum, &change], |[sum, change]| sum + share * change);
            (sum, State::combine([&size, &change], |[size, change]| size + (share * change).abs()))
        },
    )
}

/// `found` against `powers` times the state, field by field, relative to the terms of the sums.
#[track_caller]
fn close_states(
    found: (State<f64>, State<f64>),
    state: &State<f64>,
    powers: &State<f64>,
    what: impl std::fmt::Debug + Copy,
) {
    let expected = State::combine([powers, state], |[power, value]| power * value);
    let scale = State::combine([&found.1, &expected], |[size, expected]| size + expected.abs());
    // What does not change at all has the rounding of the field itself.
    let tolerance = State::combine([&scale, state], |[scale, value]| 1e-11 * scale + f64::EPSILON * value.abs());
    State::combine([&found.0, &expected, &tolerance], |[found, expected, tolerance]| {
        close(found, expected, tolerance, what);
    });
}

/// The state with all digits of its compliance, which a solve leaves at those of the step before its last.
fn exact(case: &Case) -> State<f64> {
    State { compliance_m3_per_pa: case.by(Parameter::Pressure).volume_m3, ..case.state }
}

fn powers(pressure: f64, length: f64, volume: f64, compliance: f64) -> State<f64> {
    State {
        pressure_pa: pressure,
        axial_stretch: 0.0,
        axial_strain: 0.0,
        inner_radius_m: length,
        outer_radius_m: length,
        twist_rad: 0.0,
        bend_angle_rad: 0.0,
        volume_m3: volume,
        volume_strain: 0.0,
        compliance_m3_per_pa: compliance,
    }
}

#[test]
fn an_actuator_twice_as_large_deforms_alike() {
    for case in cases() {
        // A bending actuator without a winding of its own is wound at its outer radius, so that all its lengths are here too.
        let found = scaled(&case, &LENGTHS, |parameter| case.by(parameter));
        close_states(found, &exact(&case), &powers(0.0, 1.0, 3.0, 3.0), (&case.p, case.load));
    }
}

#[test]
fn an_actuator_twice_as_stiff_takes_twice_the_loads() {
    for case in cases() {
        let found = scaled(&case, &STRESSES, |parameter| case.by(parameter));
        close_states(found, &exact(&case), &powers(1.0, 0.0, 0.0, -1.0), (&case.p, case.load));
    }
}

fn targets(case: &Case) -> Vec<Target<f64>> {
    if case.p.motion == Motion::Bending {
        return vec![Target::BendAngle(0.0)];
    }
    let mut targets = vec![Target::AxialStretch(1.0), Target::OuterRadius(1.0), Target::InnerRadius(1.0)];
    if case.state.twist_rad != 0.0 {
        targets.push(Target::Twist(0.0));
    }
    targets
}

fn of(target: Target<f64>, state: &State<f64>) -> f64 {
    match target {
        Target::AxialStretch(_) => state.axial_stretch,
        Target::OuterRadius(_) => state.outer_radius_m,
        Target::InnerRadius(_) => state.inner_radius_m,
        Target::Twist(_) => state.twist_rad,
        Target::BendAngle(_) => state.bend_angle_rad,
    }
}

/// At a given target the pressure is in proportion to all moduli and loads; a bare tube's is to its one modulus, `dP/dmu = P/mu`.
#[test]
fn the_pressure_for_a_target_scales_with_the_moduli() {
    for case in cases() {
        for target in targets(&case) {
            let inputs: Vec<_> =
                STRESSES.into_iter().filter(|(parameter, _)| *parameter != Parameter::Pressure).collect();
            let (found, size) = scaled(&case, &inputs, |parameter| case.inverse_by(target, parameter));
            let pressure_pa = case.state.pressure_pa;
            close(found.pressure_pa, pressure_pa, 1e-11 * (size.pressure_pa + pressure_pa.abs()), (target, &case.p));
        }
    }
    let bare = Case::new(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)), 25e3, 0.0, 0.0);
    let by_modulus = bare.inverse_by(Target::OuterRadius(1.0), Parameter::ShearModulus).pressure_pa;
    close(by_modulus, 25e3 / 0.2e6, 1e-14, "dP/dmu");
}

/// `dP/dp = -(dq/dp)/(dq/dP)`; the state then changes by both, and the target does not.
#[test]
fn inverse_derivative_is_the_forward_one_with_the_pressure_adapted() {
    for case in cases() {
        let by_pressure = case.by(Parameter::Pressure);
        for target in targets(&case) {
            for parameter in case.actuator.inputs().filter(|parameter| *parameter != Parameter::Pressure) {
                let (direct, adapted) = (case.by(parameter), case.inverse_by(target, parameter));
                let expected = -of(target, &direct) / of(target, &by_pressure);
                let scale =
                    expected.abs() + 1e-3 * case.state.pressure_pa.abs() / case.value(parameter).abs().max(1e-6);
                close(adapted.pressure_pa, expected, 1e-10 * scale, (parameter, target, &case.p));
                let rest = of(target, &adapted).abs();
                assert!(
                    rest <= 1e-12 * (of(target, &direct).abs() + of(target, &case.state).abs()),
                    "{target:?} moves"
                );
                let volume = direct.volume_m3 + by_pressure.volume_m3 * expected;
                let size = direct.volume_m3.abs() + (by_pressure.volume_m3 * expected).abs();
                close(adapted.volume_m3, volume, 1e-10 * size, (parameter, target, &case.p));
            }
        }
    }
}

/// `dV/dP` is a field of the state: the same to the digits of the solver, and to all digits where it searches the branch.
#[test]
fn compliance_is_the_volumes_derivative_by_the_pressure() {
    for case in cases() {
        let by_pressure = case.by(Parameter::Pressure);
        let compliance = case.state.compliance_m3_per_pa;
        close(by_pressure.volume_m3, compliance, 1e-8 * compliance, case.p);
        close(by_pressure.pressure_pa, 1.0, 0.0, case.p);
        let searched = case.actuator.by_search().forward(case.state.pressure_pa, &case.load).expect("finite").state;
        let compliance = searched.compliance_m3_per_pa;
        close(by_pressure.volume_m3, compliance, 1e-11 * compliance, case.p);
    }
}

/// Stiff windings, thin and thick walls, to 1e6 times as stiff as the wall: what single precision takes most care with.
fn stiff_cases() -> Vec<Case> {
    let mut cases = vec![];
    for (outer_mm, angle_deg, placement) in [
        (8.0, 5.0, Placement::Sheet),
        (8.0, 28.0, Placement::Sheet),
        (8.0, 75.0, Placement::Sheet),
        (6.1, 40.0, Placement::Sheet),
        (8.0, 0.0, Placement::Sheet),
        (8.0, 90.0, Placement::Sheet),
        (8.0, 20.0, Placement::Smeared),
        (12.0, 60.0, Placement::Layer),
    ] {
        for modulus_pa in [2e10, 2e11] {
            for (families, torque_nm) in [(Families::One, 0.0), (Families::Two, 0.0), (Families::Two, 2e-3)] {
                let p = tube(Motion::Twisting, 6.0, outer_mm, neo_hookean(0.2e6));
                let p = wound(p, angle_deg, families, modulus_pa, placement, 0.05);
                cases.push(Case::new(p, if outer_mm < 7.0 { 1.5e3 } else { 20e3 }, 0.3, torque_nm));
            }
        }
    }
    cases
}

/// Single precision against double, in units of its rounding and relative to the largest change of its kind; times the
/// condition of the state.
#[test]
fn single_precision_has_its_digits() {
    let mut worst: f64 = 0.0;
    for case in cases().into_iter().chain(stiff_cases()) {
        let p = single(&case.p);
        let load = Load { force_n: case.load.force_n as f32, torque_nm: case.load.torque_nm as f32 };
        let pressure_pa = case.state.pressure_pa as f32;
        // What single precision computes with, in double precision.
        let exact = Case::new(widened(&p), pressure_pa.into(), load.force_n.into(), load.torque_nm.into());
        let actuator = Actuator::new(&p).expect("valid");
        let solution = actuator.forward(pressure_pa, &load).expect("finite");
        assert_eq!(solution.status, Status::Solved, "{p:?}");
        let condition = exact.actuator.condition(&exact.state, &exact.load).expect("a state");
        let found = actuator.condition(&solution.state, &load).expect("a state");
        assert!((f64::from(found) / condition - 1.0).abs() < 1e-3, "condition {found} against {condition}, {p:?}");
        for parameter in actuator.inputs() {
            let found = actuator.sensitivity(&solution.state, &load, parameter).expect("a derivative");
            let found = State::combine([&found], |[field]| f64::from(field));
            let strain = |s: &State<f64>| [s.axial_strain, s.volume_strain, s.twist_rad + s.bend_angle_rad];
            let largest = |s: &State<f64>| strain(s).into_iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            // An input that hardly matters is judged as if it did a little.
            let little = 1e-3 * largest(&exact.state) / exact.value(parameter).abs().max(1e-3);
            let scale = largest(&exact.by(parameter)).max(little);
            for (found, expected) in strain(&found).into_iter().zip(strain(&exact.by(parameter))) {
                let error = (found - expected).abs() / (scale * condition * f64::from(f32::EPSILON));
                worst = worst.max(error);
                assert!(error <= 5.0, "{parameter:?} {found} {expected} {error} {condition} {p:?} {load:?}");
            }
        }
    }
    println!("largest error of a derivative in f32: {worst:.2} eps cond");
}

fn widened(p: &ActuatorParameters<f32>) -> ActuatorParameters<f64> {
    let mut wide = p.map(f64::from);
    if let Some(fiber) = &mut wide.fiber {
        // The single-precision quarter turn is a little more than one.
        fiber.angle_rad = fiber.angle_rad.clamp(-FRAC_PI_2, FRAC_PI_2);
    }
    wide
}
