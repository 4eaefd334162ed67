//! The tracker follows a tube to where the search along the branch finds it, and takes no tube that has no closed forms.

use fra_model::*;

/// Its name, the tube, what its setpoint asks of a state, and the highest pressure, Pa.
type Tube = (&'static str, ActuatorParameters<f64>, fn(&State<f64>) -> Target<f64>, f64);

/// Tubes that have closed forms.
fn tubes() -> Vec<Tube> {
    let tube = |motion, fiber: Option<(f64, Families)>| ActuatorParameters {
        motion,
        inner_radius_m: 10e-3,
        outer_radius_m: 14e-3,
        length_m: 0.24,
        material: Material::NeoHookean { shear_modulus_pa: 0.223e6 },
        fiber: fiber.map(|(angle_deg, families)| Fiber {
            angle_rad: angle_deg.to_radians(),
            families,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            radius_m: 14e-3,
        }),
    };
    vec![
        ("long", tube(Motion::Extension, Some((3.0, Families::Two))), |s| Target::AxialStretch(s.axial_stretch), 97e3),
        (
            "short",
            tube(Motion::Extension, Some((45.0, Families::Two))),
            |s| Target::AxialStretch(s.axial_stretch),
            60e3,
        ),
        ("wide", tube(Motion::Expansion, Some((85.0, Families::Two))), |s| Target::OuterRadius(s.outer_radius_m), 50e3),
        (
            "wide inside",
            tube(Motion::Expansion, Some((80.0, Families::Two))),
            |s| Target::InnerRadius(s.inner_radius_m),
            50e3,
        ),
        ("twisted", tube(Motion::Twisting, Some((28.0, Families::One))), |s| Target::Twist(s.twist_rad), 97e3),
        ("twisted back", tube(Motion::Twisting, Some((-28.0, Families::One))), |s| Target::Twist(s.twist_rad), 97e3),
        ("bare", tube(Motion::Expansion, None), |s| Target::OuterRadius(s.outer_radius_m), 20e3),
    ]
}

fn single(parameters: &ActuatorParameters<f64>) -> Tracker<f32> {
    Tracker::new(&parameters.map(|value| value as f32)).expect("valid").expect("closed forms")
}

fn rounded(target: Target<f64>) -> Target<f32> {
    target.map(|value| value as f32)
}

#[test]
fn pressures_up_and_down_are_followed_to_the_states_that_the_search_finds() {
    for (name, parameters, _, top_pa) in tubes() {
        let tracker = single(&parameters);
        let actuator = Actuator::new(&parameters).unwrap().by_search();
        let mut here = tracker.rest();
        let rest = actuator.rest();
        assert!((f64::from(here.volume_m3) / rest.volume_m3 - 1.0).abs() < 1e-6, "{name}");
        assert!((f64::from(here.compliance_m3_per_pa) / rest.compliance_m3_per_pa - 1.0).abs() < 1e-3, "{name}");
        for step in (0..=50).chain((0..50).rev()) {
            let pressure_pa = (top_pa * f64::from(step) / 50.0) as f32;
            here = tracker.forward(&here, pressure_pa).unwrap().unwrap_or_else(|| panic!("{name} at {pressure_pa}"));
            assert_eq!(here.pressure_pa, pressure_pa);
            let exact = actuator.forward(f64::from(pressure_pa), &Load::none()).unwrap().state;
            let off = |found: f32, exact: f64| (f64::from(found) - exact).abs();
            assert!(off(here.axial_stretch, exact.axial_stretch) < 2e-6, "{name} at {pressure_pa}");
            assert!(off(here.outer_radius_m, exact.outer_radius_m) < 1e-7, "{name} at {pressure_pa}");
            assert!(off(here.twist_rad, exact.twist_rad) < 2e-4, "{name} at {pressure_pa}");
            assert!(off(here.volume_m3, exact.volume_m3) < 1e-5 * exact.volume_m3, "{name} at {pressure_pa}");
            let compliance = exact.compliance_m3_per_pa;
            assert!(off(here.compliance_m3_per_pa, compliance) < 1e-3 * compliance, "{name} at {pressure_pa}");
        }
    }
}

#[test]
fn deformations_up_and_down_need_the_pressures_that_the_search_finds() {
    for (name, parameters, target, top_pa) in tubes() {
        let tracker = single(&parameters);
        let actuator = Actuator::new(&parameters).unwrap().by_search();
        let mut here = tracker.rest();
        for step in (1..=50).chain((0..50).rev()) {
            let wanted_pa = top_pa * f64::from(step) / 50.0;
            let asked = target(&actuator.forward(wanted_pa, &Load::none()).unwrap().state);
            here = tracker.inverse(&here, rounded(asked)).unwrap().unwrap_or_else(|| panic!("{name} at {wanted_pa}"));
            // A deformation in single precision is worth some pascals of the hundred thousand.
            let off = (f64::from(here.pressure_pa) - wanted_pa).abs();
            assert!(off < 2e-4 * top_pa, "{name} at {wanted_pa}: {}", here.pressure_pa);
        }
    }
}

#[test]
fn short_and_long_steps_towards_a_deformation_end_in_the_same_digits() {
    for (name, parameters, target, top_pa) in tubes() {
        let tracker = single(&parameters);
        let actuator = Actuator::new(&parameters).unwrap().by_search();
        let exactly = |pressure_pa: f64| actuator.forward(pressure_pa, &Load::none()).unwrap().state;
        for step in [1e-3, 3e-3, 1e-2, 2e-2, 3e-2, 6e-2] {
            let mut here = tracker.rest();
            for tenth in 1..10 {
                let began_pa = top_pa * f64::from(tenth) / 10.0;
                here = tracker.forward(&here, began_pa as f32).unwrap().unwrap_or_else(|| panic!("{name}"));
                let wanted_pa = began_pa * (1.0 + step);
                let asked = rounded(target(&exactly(wanted_pa)));
                let found = tracker.inverse(&here, asked).unwrap().unwrap_or_else(|| panic!("{name} at {wanted_pa}"));
                let pressure_pa = f64::from(found.pressure_pa);
                assert!((pressure_pa - wanted_pa).abs() < 3e-6 * top_pa, "{name} at {wanted_pa}: {pressure_pa}");
                let off = f64::from(found.compliance_m3_per_pa) / exactly(pressure_pa).compliance_m3_per_pa - 1.0;
                assert!(off.abs() < 4e-6, "{name} at {wanted_pa}, step {step}: compliance off by {off:e}");
            }
        }
    }
}

#[test]
fn closed_form_solver_of_the_actuator_gives_the_same_bits() {
    for (name, parameters, target, top_pa) in tubes() {
        let (tracker, actuator) = (Tracker::new(&parameters).unwrap().unwrap(), Actuator::new(&parameters).unwrap());
        let mut here = actuator.forward(0.3 * top_pa, &Load::none()).unwrap().state;
        for share in [0.31, 0.35, 0.5, 0.2] {
            let next = actuator.forward_near(&here, share * top_pa, &Load::none(), 100).unwrap().state;
            assert_eq!(tracker.forward(&here, share * top_pa), Ok(Some(next)), "{name}");
            let asked = target(&actuator.forward((share + 0.01) * top_pa, &Load::none()).unwrap().state);
            let solution = actuator.inverse_near(&next, asked, &Load::none(), 100).unwrap();
            assert_eq!(tracker.inverse(&next, asked), Ok(Some(solution.state)), "{name}");
            here = next;
        }
    }
}

#[test]
fn actuators_without_closed_forms_are_not_taken_and_wrong_ones_are_named() {
    let (_, parameters, ..) = tubes().remove(0);
    let fiber = parameters.fiber.unwrap();
    let yeoh = Material::Yeoh { c_pa: [96e3, 9.5e3, 0.0] };
    for other in [
        ActuatorParameters { motion: Motion::Bending, ..parameters },
        ActuatorParameters { material: yeoh, ..parameters },
        ActuatorParameters { fiber: Some(Fiber { placement: Placement::Smeared, ..fiber }), ..parameters },
        ActuatorParameters {
            fiber: Some(Fiber { placement: Placement::Layer, radius_m: 12e-3, ..fiber }),
            ..parameters
        },
    ] {
        assert!(Tracker::new(&other).unwrap().is_none(), "{other:?}");
    }
    let refused = Tracker::new(&ActuatorParameters { length_m: 0.0, ..parameters }).unwrap_err();
    assert_eq!(refused.field, "length_m");
}

#[test]
fn queries_that_make_no_sense_are_errors_and_states_that_make_none_have_no_answer() {
    let (_, parameters, ..) = tubes().remove(0);
    let tracker = single(&parameters);
    let rest = tracker.rest();
    assert_eq!(tracker.forward(&rest, f32::NAN).unwrap_err().field, "pressure_pa");
    assert_eq!(tracker.inverse(&rest, Target::AxialStretch(0.0)).unwrap_err().field, "axial_stretch");
    assert_eq!(tracker.inverse(&rest, Target::Twist(f32::INFINITY)).unwrap_err().field, "twist_rad");
    assert_eq!(tracker.inverse(&rest, Target::BendAngle(0.1)).unwrap_err().field, "bend_angle_rad");
    let broken = |value: f32| State { axial_strain: value, volume_strain: value, twist_rad: value, ..rest };
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, -3.0] {
        assert_eq!(tracker.forward(&broken(value), 10e3), Ok(None), "{value}");
        assert_eq!(tracker.inverse(&broken(value), Target::AxialStretch(1.01)), Ok(None), "{value}");
    }
    // Far beyond what a tube can do.
    assert_eq!(tracker.forward(&rest, f32::MAX), Ok(None));
    assert_eq!(tracker.inverse(&rest, Target::AxialStretch(f32::MAX)), Ok(None));
}
