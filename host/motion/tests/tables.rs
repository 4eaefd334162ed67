//! Tables for the device: compared with the inverse model, which their builder does not ask; refused where they do not fit.

use fra_model::StateQuantity;
use fra_model::*;
use softlimb_limb::StateCurve;
use softlimb_motion::inverse_table::{
    DenseTable, DeviceTables, NoTable, Subject, Verified, device_tables, inverse_of_degree, verify,
};

const ATMOSPHERE_PA: f64 = 101_325.0;

/// The error that scenes allow by default.
const BUDGET: f64 = 1e-4;

/// An actuator of 10/14 mm by 240 mm in a Kevlar-like winding, or a softer one.
fn actuator(motion: Motion, angle_deg: f64, families: Families, modulus_pa: f64) -> Actuator<f64> {
    let fiber = Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: 14e-3,
    };
    let parameters = ActuatorParameters {
        motion,
        inner_radius_m: 10e-3,
        outer_radius_m: 14e-3,
        length_m: 0.24,
        material: Material::NeoHookean { shear_modulus_pa: 0.223e6 },
        fiber: Some(fiber),
    };
    Actuator::new(&parameters).expect("valid")
}

/// Actuators whose quantity runs smoothly and one way.
fn smooth() -> Vec<(&'static str, Actuator<f64>, StateQuantity, f64)> {
    use Families::{One, Two};
    use StateQuantity::{AxialStretch, BendAngle, InnerRadius, OuterRadius, Twist};
    let kevlar = 361e6;
    vec![
        ("long", actuator(Motion::Extension, 3.0, Two, kevlar), AxialStretch, 97e3),
        ("short", actuator(Motion::Extension, 45.0, Two, kevlar), AxialStretch, 60e3),
        ("wide", actuator(Motion::Expansion, 85.0, Two, kevlar), OuterRadius, 50e3),
        ("wide inside", actuator(Motion::Expansion, 90.0, Two, kevlar), InnerRadius, 50e3),
        ("bent", actuator(Motion::Bending, 0.0, Two, kevlar), BendAngle, 97e3),
        ("twisted", actuator(Motion::Twisting, 28.0, One, kevlar), Twist, 97e3),
        ("twisted back", actuator(Motion::Twisting, -28.0, One, kevlar), Twist, 97e3),
    ]
}

fn target(kind: StateQuantity, value: f64) -> Target<f64> {
    match kind {
        StateQuantity::AxialStretch => Target::AxialStretch(value),
        StateQuantity::OuterRadius => Target::OuterRadius(value),
        StateQuantity::InnerRadius => Target::InnerRadius(value),
        StateQuantity::Twist => Target::Twist(value),
        StateQuantity::BendAngle | StateQuantity::Pressure => Target::BendAngle(value),
    }
}

/// Numbers between 0 and 1 without a pattern: the fractional parts of the multiples of the golden ratio.
fn shares(count: u32) -> impl Iterator<Item = f64> {
    (1..=count).map(|index| (f64::from(index) * 0.618_033_988_749_894_9).fract())
}

fn with_tables(check: impl Fn(&str, &Subject, &DeviceTables)) {
    for (name, actuator, kind, pressure_max_pa) in smooth() {
        let curve = StateCurve::new(&actuator, pressure_max_pa);
        let subject = Subject::new(&actuator, kind, &curve);
        let tables = device_tables(&subject, BUDGET, ATMOSPHERE_PA).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        check(name, &subject, &tables);
    }
}

#[test]
fn the_verified_error_holds_for_the_inverse_model() {
    with_tables(|name, subject, tables| {
        let fit = tables.inverse.as_ref().unwrap();
        let table = fit.table().unwrap();
        let highest_pa = f64::from(fit.pressure_max_pa);
        assert!(fit.error <= BUDGET, "{name}: {:e}", fit.error);
        let mut most = 0.0_f64;
        for share in shares(2_000) {
            // Any single-precision setpoint; the question to the model is exactly that one.
            let setpoint = (f64::from(fit.from) + share * f64::from(fit.to - fit.from)) as f32;
            let found = table.lookup(setpoint).unwrap().pressure_pa;
            let start = subject.curve.at(f64::from(found));
            let exact = subject
                .actuator
                .inverse_from(&start, target(subject.kind, f64::from(setpoint)), &Load::none())
                .unwrap();
            assert_eq!(exact.status, Status::Solved, "{name} at {setpoint}");
            most = most.max((f64::from(found) - exact.state.pressure_pa).abs() / highest_pa);
        }
        println!(
            "{name}: degree {}, {} steps, verified {:.2e}, found {most:.2e}",
            fit.coefficients_pa.len() - 1,
            fit.steps,
            fit.error
        );
        assert!(most <= fit.error * 1.000_001, "{name}: {most:e} is more than the verified {:e}", fit.error);
        assert!(
            most >= 0.3 * fit.error,
            "{name}: the verified error is far from the real one: {most:e} {:e}",
            fit.error
        );
    });
}

#[test]
fn volumes_and_compliances_are_the_models() {
    with_tables(|name, subject, tables| {
        let fit = &tables.volume;
        let table = VolumeTable::new(fit.pressure_max_pa, &fit.coefficients_m3).unwrap();
        for share in shares(300) {
            let pressure_pa = (share * f64::from(fit.pressure_max_pa)) as f32;
            let found = table.lookup(pressure_pa).unwrap();
            let state = subject.actuator.forward(f64::from(pressure_pa), &Load::none()).unwrap().state;
            let absolute_pa = 1.2 * (ATMOSPHERE_PA + f64::from(pressure_pa));
            let difference = (f64::from(found.volume_m3) - state.volume_m3).abs()
                + absolute_pa * (f64::from(found.compliance_m3_per_pa) - state.compliance_m3_per_pa).abs();
            let air = state.volume_m3 + absolute_pa * state.compliance_m3_per_pa;
            assert!(difference <= 1.001 * fit.error * air, "{name} at {pressure_pa}: {:e}", difference / air);
        }
        assert!(fit.error <= 1e-3, "{name}: {:e}", fit.error);
    });
}

#[test]
fn the_dense_table_is_the_model_to_a_billionth() {
    for (name, actuator, kind, pressure_max_pa) in smooth() {
        let curve = StateCurve::new(&actuator, pressure_max_pa);
        let subject = Subject::new(&actuator, kind, &curve);
        let table = DenseTable::new(&subject, Argument::Linear, 1024).unwrap();
        let (from, to) = table.range();
        let mut most = 0.0_f64;
        for share in shares(500) {
            let value = from + share * (to - from);
            let found = table.pressure_pa(value).unwrap();
            let exact =
                actuator.inverse_from(&curve.at(found), target(kind, value), &Load::none()).unwrap().state.pressure_pa;
            most = most.max((found - exact).abs() / pressure_max_pa);
        }
        println!("{name}: {most:.1e} of full scale, {:.1e} in the middles", table.error_pa() / pressure_max_pa);
        assert!(most <= 1e-9, "{name}: {most:e}");
        assert_eq!(table.pressure_pa(from).unwrap(), 0.0);
        assert_eq!(table.pressure_pa(f64::NAN), Err(NotFinite));
        let beyond = table.pressure_pa(to + (to - from)).unwrap();
        assert!((beyond - pressure_max_pa).abs() <= 1e-9 * pressure_max_pa, "{name}: {beyond}");
    }
}

#[test]
fn pressure_at_the_neutral_angle_is_a_function_of_the_root() {
    let neutral = actuator(Motion::Extension, 0.5_f64.sqrt().atan().to_degrees(), Families::Two, 361e6);
    let curve = StateCurve::new(&neutral, 97e3);
    let subject = Subject::new(&neutral, StateQuantity::AxialStretch, &curve);
    let fit = device_tables(&subject, BUDGET, ATMOSPHERE_PA).unwrap().inverse.unwrap();
    assert_eq!(fit.argument, Argument::Root);
    let table = fit.table().unwrap();
    for share in shares(500) {
        let pressure_pa = 97e3 * share;
        let stretch = neutral.forward(pressure_pa, &Load::none()).unwrap().state.axial_stretch as f32;
        let found = f64::from(table.lookup(stretch).unwrap().pressure_pa);
        // The setpoint is rounded to single precision, which the root magnifies near rest.
        let rounded = 6e-8 * 97e3 / (2.0 * f64::from(fit.to - fit.from) * share);
        assert!((found - pressure_pa).abs() <= fit.error * 97e3 + rounded, "{pressure_pa}: {found}");
    }
}

#[test]
fn wrong_table_is_found_out() {
    let (_, actuator, kind, pressure_max_pa) = smooth().remove(0);
    let curve = StateCurve::new(&actuator, pressure_max_pa);
    let subject = Subject::new(&actuator, kind, &curve);
    let exact = DenseTable::new(&subject, Argument::Linear, 256).unwrap();
    let good = device_tables(&subject, BUDGET, ATMOSPHERE_PA).unwrap().inverse.unwrap();
    let again = verify(&good, &exact).unwrap();
    assert_eq!(again, Verified { error: good.error, rises: true });

    let mut shifted = good.clone();
    shifted.coefficients_pa[0] += 0.01 * shifted.pressure_max_pa;
    let error = verify(&shifted, &exact).unwrap().error;
    assert!((error - 0.01).abs() < 2e-4, "a shift by a hundredth: {error:e}");

    let mut wavy = good.clone();
    wavy.coefficients_pa.resize(17, 0.0);
    wavy.coefficients_pa[16] += 0.02 * wavy.pressure_max_pa;
    assert!(!verify(&wavy, &exact).unwrap().rises, "a ripple of 2 %");

    let mut coarse = good.clone();
    coarse.steps = 256;
    assert!(verify(&coarse, &exact).unwrap().error > 1e-3, "half a step of 256");

    let mut broken = good;
    broken.coefficients_pa[1] = f32::NAN;
    assert_eq!(verify(&broken, &exact), None, "the device would refuse it");
}

#[test]
fn untabulated_actuators_have_a_reason() {
    let refused = |actuator: &Actuator<f64>, kind, pressure_max_pa, budget| {
        let curve = StateCurve::new(actuator, pressure_max_pa);
        device_tables(&Subject::new(actuator, kind, &curve), budget, ATMOSPHERE_PA).expect_err("this has no table")
    };
    // Beyond the neutral angle the stretch falls at first; stiff at large strain, a soft winding lets it turn.
    let turning = actuator(Motion::Extension, 35.5, Families::Two, 1e6);
    let reason = refused(&turning, StateQuantity::AxialStretch, 97e3, BUDGET);
    let NoTable::NotMonotone { pressure_pa } = reason else { panic!("{reason:?}") };
    let stretch = |pressure_pa| turning.forward(pressure_pa, &Load::none()).unwrap().state.axial_stretch;
    let around = [pressure_pa - 500.0, pressure_pa, pressure_pa + 500.0].map(|p| stretch(f64::max(p, 0.0)));
    assert!((around[1] - around[0]) * (around[2] - around[1]) <= 0.0 || pressure_pa == 0.0, "{pressure_pa} {around:?}");

    // Single precision cannot keep a millionth.
    let long = actuator(Motion::Extension, 3.0, Families::Two, 361e6);
    let reason = refused(&long, StateQuantity::AxialStretch, 97e3, 1e-6);
    let NoTable::Inverse { least: Some(least), budget } = reason else { panic!("{reason:?}") };
    assert!(least > 1e-6 && least < BUDGET && budget == 1e-6, "{least:e}");

    // The curve ends just below the limit point, where the volume runs away.
    let wide = actuator(Motion::Expansion, 90.0, Families::Two, 361e6);
    let reason = refused(&wide, StateQuantity::OuterRadius, 97e3, BUDGET);
    assert!(matches!(reason, NoTable::Volume { .. }), "{reason:?}");
}

#[test]
fn error_falls_with_the_degree_to_that_of_the_grid() {
    let (_, actuator, kind, pressure_max_pa) = smooth().remove(4);
    let curve = StateCurve::new(&actuator, pressure_max_pa);
    let subject = Subject::new(&actuator, kind, &curve);
    let exact = DenseTable::new(&subject, Argument::Linear, 256).unwrap();
    let errors: Vec<f64> =
        (1..=16).map(|degree| inverse_of_degree(&subject, &exact, degree).map_or(f64::NAN, |fit| fit.error)).collect();
    println!("{errors:?}");
    assert!(errors[..6].windows(2).all(|pair| pair[1] < pair[0]), "{errors:?}");
    // Half a step of 32 768 where the pressure rises fastest, and single precision.
    let steepest = (1..=1000)
        .map(|k| exact.pressure_pa(f64::from(k) / 1000.0 * exact.range().1).unwrap())
        .scan(0.0, |before, now| Some(now - std::mem::replace(before, now)))
        .fold(0.0, f64::max)
        * 1000.0
        / pressure_max_pa;
    let floor = 0.5 * steepest / 32_768.0;
    assert!(errors[15] > 0.9 * floor && errors[15] < floor + 2e-6, "{:e} {floor:e}", errors[15]);
}

/// A number of the sequence between two bounds.
fn between(numbers: &mut impl Iterator<Item = f64>, low: f64, high: f64) -> f64 {
    low + (high - low) * numbers.next().unwrap()
}

#[test]
fn random_actuators_have_a_table_that_holds_or_a_reason() {
    // Fractional parts of the multiples of sqrt 2, sqrt 3 and so on are equally distributed in as many dimensions.
    let roots = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0].map(f64::sqrt);
    let (mut tables, mut reasons) = (0, std::collections::BTreeMap::<String, u32>::new());
    for index in 1..=80_u32 {
        let mut numbers = roots.into_iter().map(|root| (root * f64::from(index)).fract());
        let inner_radius_m = between(&mut numbers, 3e-3, 15e-3);
        let outer_radius_m = inner_radius_m * between(&mut numbers, 1.1, 1.8);
        let shear_modulus_pa = 10f64.powf(between(&mut numbers, 4.7, 5.7));
        let modulus_pa = shear_modulus_pa * 10f64.powf(between(&mut numbers, 1.0, 4.0));
        let angle_rad = between(&mut numbers, 1.0, 89.0_f64).to_radians();
        let pressure_max_pa = shear_modulus_pa * between(&mut numbers, 0.05, 0.6);
        let (motion, kind, families) = match index % 4 {
            0 => (Motion::Extension, StateQuantity::AxialStretch, Families::Two),
            1 => (Motion::Expansion, StateQuantity::OuterRadius, Families::Two),
            2 => (Motion::Bending, StateQuantity::BendAngle, Families::Two),
            _ => (Motion::Twisting, StateQuantity::Twist, Families::One),
        };
        let fiber = Fiber {
            angle_rad,
            families,
            modulus_pa,
            placement: Placement::Sheet,
            thickness_m: 0.2e-3,
            radius_m: outer_radius_m,
        };
        let parameters = ActuatorParameters {
            motion,
            inner_radius_m,
            outer_radius_m,
            length_m: 0.15,
            material: Material::NeoHookean { shear_modulus_pa },
            fiber: Some(fiber),
        };
        let actuator = Actuator::new(&parameters).unwrap();
        let curve = StateCurve::new(&actuator, pressure_max_pa);
        let subject = Subject::new(&actuator, kind, &curve);
        let fit = match device_tables(&subject, BUDGET, ATMOSPHERE_PA) {
            Ok(found) => found.inverse.unwrap(),
            Err(reason) => {
                let name = format!("{reason:?}");
                *reasons.entry(name.split([' ', '{']).next().unwrap().into()).or_default() += 1;
                continue;
            }
        };
        tables += 1;
        let table = fit.table().unwrap();
        let highest_pa = f64::from(fit.pressure_max_pa);
        for share in shares(40) {
            let setpoint = (f64::from(fit.from) + share * f64::from(fit.to - fit.from)) as f32;
            let found = f64::from(table.lookup(setpoint).unwrap().pressure_pa);
            let exact =
                actuator.inverse_from(&curve.at(found), target(kind, f64::from(setpoint)), &Load::none()).unwrap();
            assert_eq!(exact.status, Status::Solved, "{parameters:?} at {setpoint}");
            let error = (found - exact.state.pressure_pa).abs() / highest_pa;
            assert!(error <= fit.error * 1.000_1, "{parameters:?} at {setpoint}: {error:e} {:e}", fit.error);
        }
    }
    println!("{tables} of 80 have tables; the others: {reasons:?}");
    assert!(tables >= 40, "{tables}: {reasons:?}");
}
