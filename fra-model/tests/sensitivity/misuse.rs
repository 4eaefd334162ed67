//! What has no derivative says so.

use super::*;

fn message(found: Result<State<f64>, NoDerivative<f64>>) -> String {
    found.expect_err("refused").to_string()
}

#[test]
fn inputs_an_actuator_does_not_have_are_named() {
    use Parameter::*;
    let bare = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
    let smeared = wound(bare, 10.0, Families::Two, 1e6, Placement::Smeared, 0.2);
    let layer = wound(bare, 10.0, Families::Two, 1e6, Placement::Layer, 0.2);
    let sheet =
        wound(tube(Motion::Expansion, 6.0, 8.0, DRAGONSKIN_30), 10.0, Families::Two, 1e6, Placement::Sheet, 0.2);
    let bending = ActuatorParameters { motion: Motion::Bending, ..sheet };
    let always = [InnerRadius, OuterRadius, Length, Pressure, Force, Torque];
    let yeoh = [YeohC1, YeohC2, YeohC3];
    let winding = [FiberAngle, FiberModulus, SheetThickness, WindingRadius];
    for (p, own) in [
        (bare, vec![ShearModulus]),
        (smeared, vec![ShearModulus, FiberAngle, FiberModulus]),
        (layer, vec![ShearModulus, FiberAngle, FiberModulus, WindingRadius]),
        (sheet, [&yeoh[..], &winding].concat()),
        (bending, [&yeoh[..], &[FiberAngle, WindingRadius]].concat()),
        (ActuatorParameters { motion: Motion::Bending, ..layer }, vec![ShearModulus, WindingRadius]),
        (ActuatorParameters { motion: Motion::Bending, ..bare }, vec![ShearModulus]),
    ] {
        let case = Case::new(p, 10e3, 0.0, 0.0);
        let mut expected = [&always[..], &own].concat();
        let mut found: Vec<_> = case.actuator.inputs().collect();
        expected.sort_by_key(|parameter| parameter.name());
        found.sort_by_key(|parameter| parameter.name());
        assert_eq!(found, expected, "{p:?}");
        for parameter in Parameter::ALL {
            let refused = case.actuator.sensitivity(&case.state, &case.load, parameter);
            let expected = format!("{} is not an input of this actuator", parameter.name());
            match found.contains(&parameter) {
                true => assert!(refused.is_ok(), "{parameter:?} {refused:?}"),
                false => assert_eq!(message(refused), expected),
            }
        }
    }
}

#[test]
fn targets_loads_and_states_of_something_else_are_refused() {
    let straight = Case::new(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)), 20e3, 0.0, 0.0);
    let bent = Case::new(tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6)), 20e3, 0.0, 0.0);
    let by = |case: &Case, target| {
        message(case.actuator.inverse_sensitivity(&case.state, &case.load, target, Parameter::InnerRadius))
    };
    assert!(by(&straight, Target::BendAngle(1.0)).contains("bend_angle_rad = 1 is not allowed"));
    assert!(by(&bent, Target::AxialStretch(1.1)).contains("axial_stretch = 1.1 is not allowed"));
    // A tube that cannot twist has no pressure that holds a twist.
    assert!(by(&straight, Target::Twist(0.0)).contains("stands still"));
    let solved_for = straight.actuator.inverse_sensitivity(
        &straight.state,
        &straight.load,
        Target::AxialStretch(1.0),
        Parameter::Pressure,
    );
    assert_eq!(solved_for, Err(NoDerivative::NotAnInput(Parameter::Pressure)));

    let infinite = Load { force_n: f64::INFINITY, torque_nm: 0.0 };
    let refused = straight.actuator.sensitivity(&straight.state, &infinite, Parameter::Pressure);
    assert!(message(refused).contains("external_force_n = inf"));
    for case in [&straight, &bent] {
        let elsewhere = [
            State { pressure_pa: 10e3, ..case.state },
            State { pressure_pa: f64::NAN, ..case.state },
            State { axial_strain: case.state.axial_strain + 0.2, ..case.state },
            State { axial_strain: f64::NAN, ..case.state },
            State { axial_strain: -2.0, ..case.state },
        ];
        for state in elsewhere {
            let refused = case.actuator.sensitivity(&state, &case.load, Parameter::InnerRadius);
            assert_eq!(refused, Err(NoDerivative::NotAnEquilibrium), "{state:?}");
            assert!(case.actuator.condition(&state, &case.load).is_err());
        }
        let other_load = Load { force_n: 3.0, torque_nm: 0.0 };
        let refused = case.actuator.sensitivity(&case.state, &other_load, Parameter::InnerRadius);
        assert_eq!(refused, Err(NoDerivative::NotAnEquilibrium));
    }
}
