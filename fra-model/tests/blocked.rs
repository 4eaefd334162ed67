//! Held actuators against published kinematics of inextensible fibers, against the free solution, and against each other.

use crate::common::*;
use fra_model::*;

/// Two stiff families as a sheet at the outer radius of a 6/8 mm tube.
fn stiff(angle_deg: f64, families: Families) -> Actuator<f64> {
    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.17e6));
    Actuator::new(&wound(p, angle_deg, families, 1e5 * 0.17e6, Placement::Sheet, 0.1)).unwrap()
}

/// Blocked at rest, push per pressure tends to `pi R_f^2 (1 - 2 tan^2 alpha)`, twist per pressure of one family to
/// `-2 pi R_f^3 tan alpha` (inextensible thread: `V = pi r^2 l`, `r = sqrt(b^2 - l^2)/(t0 + Phi)`).
#[test]
fn blocked_loads_have_the_lever_arms_of_inextensible_fibers() {
    let r = 8e-3_f64;
    for angle_deg in [1.0_f64, 20.0, 30.0, 45.0, 60.0] {
        let t = angle_deg.to_radians().tan();
        let held = stiff(angle_deg, Families::Two).blocked(50e3, 1.0, 0.0).unwrap();
        let push_m2 = -held.force_n / 50e3;
        let expected = std::f64::consts::PI * r * r * (1.0 - 2.0 * t * t);
        assert!(
            (push_m2 - expected).abs() < 4e-3 * (std::f64::consts::PI * r * r).max(expected.abs()),
            "{angle_deg}: {push_m2} against {expected}"
        );
        let one = stiff(angle_deg, Families::One).blocked(50e3, 1.0, 0.0).unwrap();
        let turn_m3 = -one.torque_nm / 50e3;
        let expected = -2.0 * std::f64::consts::PI * r * r * r * t;
        assert!(relative(turn_m3, expected) < 5e-3, "{angle_deg}: {turn_m3} against {expected}");
    }
}

/// Tabulated by an independent code: 6/8 mm with one family, blocked at 50 kPa, push and turn per pressure, mm2 and mm3.
#[test]
fn blocked_loads_match_tabulated_values() {
    for (angle_deg, expected_mm2) in [(1.0, 200.90), (30.0, 67.03), (35.264_389_7, 0.05), (45.0, -200.7)] {
        let push_mm2 = -stiff(angle_deg, Families::One).blocked(50e3, 1.0, 0.0).unwrap().force_n / 50e3 * 1e6;
        assert!((push_mm2 - expected_mm2).abs() < 0.06, "{angle_deg}: {push_mm2}");
    }
    let turn_mm3 = -stiff(30.0, Families::One).blocked(50e3, 1.0, 0.0).unwrap().torque_nm / 50e3 * 1e9;
    assert!((turn_mm3 + 1856.7).abs() < 1.0, "{turn_mm3}");
}

/// Free of blocking the push falls, since the wall is stretched: a Kevlar-like winding at 3 deg and 100 kPa.
#[test]
fn push_falls_with_the_stretch() {
    let p = tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2226e6));
    let actuator = Actuator::new(&wound(p, 3.0, Families::Two, 361e6, Placement::Sheet, 0.178)).unwrap();
    for (stretch, expected_n) in [(1.0, 19.95), (1.1, 12.14), (1.2, 6.41)] {
        let push_n = -actuator.blocked(100e3, stretch, 0.0).unwrap().force_n;
        assert!((push_n - expected_n).abs() < 0.15, "{stretch}: {push_n}");
    }
}

/// Where the free solution is, nothing is needed to hold it; with a load applied, the load.
#[test]
fn loads_of_an_equilibrium_are_those_that_made_it() {
    for families in [Families::One, Families::Two] {
        let p =
            wound(tube(Motion::Twisting, 10.0, 14.0, DRAGONSKIN_30), 28.0, families, 361e6, Placement::Sheet, 0.178);
        let actuator = Actuator::new(&p).unwrap();
        for load in [Load::none(), Load { force_n: 4.0, torque_nm: 0.0 }, Load { force_n: -3.0, torque_nm: 0.02 }] {
            let state = actuator.forward(30e3, &load).unwrap().state;
            let held = actuator.blocked(30e3, state.axial_stretch, state.twist_rad).unwrap();
            assert_eq!(held.status, Status::Solved);
            assert!(
                (held.force_n - load.force_n).abs() < 1e-7 && (held.torque_nm - load.torque_nm).abs() < 1e-9,
                "{held:?}"
            );
            assert!(relative(held.state.volume_m3, state.volume_m3) < 1e-10);
        }
    }
}

/// Derivatives against central differences of the loads, and Maxwell's relation: `dN/dPhi = dM/dl`.
#[test]
fn stiffness_and_lever_arms_are_derivatives_of_the_loads() {
    let p = wound(
        tube(Motion::Twisting, 10.0, 14.0, neo_hookean(0.2e6)),
        40.0,
        Families::One,
        2e6,
        Placement::Smeared,
        0.0,
    );
    let actuator = Actuator::new(&p).unwrap();
    let (pressure, stretch, twist) = (20e3, 1.07, 0.3);
    let loads = |pressure: f64, stretch: f64, twist: f64| {
        let held = actuator.blocked(pressure, stretch, twist).unwrap();
        [held.force_n, held.torque_nm]
    };
    let difference =
        |ahead: [f64; 2], behind: [f64; 2], step: f64| [0, 1].map(|i| (ahead[i] - behind[i]) / (2.0 * step));
    let h = 1e-5;
    let by_stretch =
        difference(loads(pressure, stretch + h, twist), loads(pressure, stretch - h, twist), h * p.length_m);
    let by_twist = difference(loads(pressure, stretch, twist + h), loads(pressure, stretch, twist - h), h);
    let by_pressure = difference(loads(pressure + 1.0, stretch, twist), loads(pressure - 1.0, stretch, twist), 1.0);
    let held = actuator.blocked(pressure, stretch, twist).unwrap();
    for row in 0..2 {
        assert!(relative(held.stiffness[row][0], by_stretch[row]) < 1e-7, "{held:?} {by_stretch:?}");
        assert!(relative(held.stiffness[row][1], by_twist[row]) < 1e-7, "{held:?} {by_twist:?}");
        assert!(relative(held.by_pressure[row], by_pressure[row]) < 1e-7, "{held:?} {by_pressure:?}");
    }
    assert!(relative(held.stiffness[0][1], held.stiffness[1][0]) < 1e-12);
}

#[test]
fn blocked_states_without_balance_have_a_status() {
    let bare = Actuator::new(&tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6))).unwrap();
    assert_eq!(bare.blocked(1e6, 1.0, 0.0).unwrap().status, Status::NoSolution);
    assert_eq!(bare.blocked(-50e3, 0.7, 1.0).unwrap().status, Status::Solved);
    assert_eq!(bare.blocked(0.0, -1.0, 0.0).unwrap_err().field, "axial_stretch");
    assert_eq!(bare.blocked(0.0, 1.0, f64::NAN).unwrap_err().field, "twist_rad");
    let bender = Actuator::new(&tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6))).unwrap();
    assert_eq!(bender.blocked(0.0, 1.0, 0.0).unwrap_err().field, "axial_stretch");
}

/// Derivatives of the loads by every input against central differences of the loads.
#[test]
fn derivatives_of_the_loads_are_slopes_of_the_loads() {
    let placements =
        [(Placement::Sheet, Families::Two), (Placement::Layer, Families::One), (Placement::Smeared, Families::One)];
    for (placement, families) in placements {
        let p = wound(tube(Motion::Twisting, 9.0, 13.0, DRAGONSKIN_30), 24.0, families, 4e6, placement, 0.178);
        let p = ActuatorParameters { fiber: p.fiber.map(|fiber| Fiber { radius_m: 11.5e-3, ..fiber }), ..p };
        let loads = |p: &ActuatorParameters<f64>, pressure_pa: f64| {
            let held = Actuator::new(p).unwrap().blocked(pressure_pa, 1.08, 0.3).unwrap();
            [held.force_n, held.torque_nm]
        };
        let actuator = Actuator::new(&p).unwrap();
        let held = actuator.blocked(40e3, 1.08, 0.3).unwrap();
        type Change = fn(&mut ActuatorParameters<f64>, f64);
        let changes: [(Parameter, f64, Change); 7] = [
            (Parameter::InnerRadius, 9e-3, |p, h| p.inner_radius_m += h),
            (Parameter::OuterRadius, 13e-3, |p, h| p.outer_radius_m += h),
            (Parameter::Length, 0.1, |p, h| p.length_m += h),
            (Parameter::FiberAngle, 0.4, |p, h| p.fiber.as_mut().unwrap().angle_rad += h),
            (Parameter::FiberModulus, 4e6, |p, h| p.fiber.as_mut().unwrap().modulus_pa += h),
            (Parameter::WindingRadius, 11.5e-3, |p, h| p.fiber.as_mut().unwrap().radius_m += h),
            (Parameter::SheetThickness, 0.178e-3, |p, h| p.fiber.as_mut().unwrap().thickness_m += h),
        ];
        let mut asked = 0;
        for (parameter, size, change) in changes {
            let Ok(found) = actuator.blocked_sensitivity(&held, parameter) else { continue };
            asked += 1;
            let step = 1e-4 * size;
            let [mut more, mut less] = [p, p];
            change(&mut more, step);
            change(&mut less, -step);
            let (more, less) = (loads(&more, 40e3), loads(&less, 40e3));
            let scale = [held.force_n, held.torque_nm].map(|x| x.abs() / size);
            for (axis, found) in [found.force_n, found.torque_nm].into_iter().enumerate() {
                let slope = (more[axis] - less[axis]) / (2.0 * step);
                let most = 2e-5 * (slope.abs() + scale[axis]) + 1e-9;
                assert!((found - slope).abs() < most, "{placement:?} {parameter:?} {axis}: {found} against {slope}");
            }
        }
        assert!(asked >= 5, "{asked} derivatives");
        let by_pressure = actuator.blocked_sensitivity(&held, Parameter::Pressure).unwrap();
        assert!(relative(by_pressure.force_n, held.by_pressure[0]) < 1e-9);
        assert!(relative(by_pressure.torque_nm, held.by_pressure[1]) < 1e-9);
        let refused = actuator.blocked_sensitivity(&held, Parameter::Force).unwrap_err();
        assert_eq!(refused, NoDerivative::NotAnInput(Parameter::Force));
    }
}
