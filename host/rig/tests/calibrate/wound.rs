//! Wound bending actuators: finite elements of the cross-section answer where the analytic bend errs by more than is accepted.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, StateQuantity};
use softlimb_fea::cross_section::{BEND_TOLERANCE, EndLoad, Options, Section, analytic_bend_error};
use softlimb_rig::calibrate::{Body, BodyModel, Branch, Noise, Observation, Property, Reason, Settings, Unknown, fit};

/// An accuracy that no instrument has, for data without noise.
const EXACT: f64 = 1e-9;

fn sheet(degrees: f64, families: Families) -> Fiber<f64> {
    Fiber {
        angle_rad: degrees.to_radians(),
        families,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: 6.1e-3,
    }
}

/// A bender of latex tubing.
fn bender(shear_modulus_pa: f64, fiber: Fiber<f64>) -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 4.8e-3,
        outer_radius_m: 6.1e-3,
        length_m: 0.18,
        material: Material::NeoHookean { shear_modulus_pa },
        fiber: Some(fiber),
    }
}

fn seen(reading_pa: f64, quantity: StateQuantity, value: f64) -> Observation {
    Observation { body: 0, reading_pa, branch: Branch::Loading, quantity, value, accuracy: EXACT }
}

/// What finite elements make of an actuator at gauge pressures, kPa, read by a sensor without errors.
fn bends(
    parameters: &ActuatorParameters<f64>,
    second: Option<&Fiber<f64>>,
    quantities: &[StateQuantity],
    kilopascals: &[f64],
) -> Vec<Observation> {
    let options = Options::default();
    let section = match second {
        None => Section::new(parameters, &options).unwrap(),
        Some(second) => Section::with_two_windings(parameters, second, &options).unwrap(),
    };
    let pressures_pa: Vec<f64> = kilopascals.iter().map(|kilopascals| 1e3 * kilopascals).collect();
    let curve = section.curve(&pressures_pa, &EndLoad::default()).unwrap();
    let states = curve.answers.iter().map(|answer| answer.equilibrium().unwrap().state.over(parameters.length_m));
    states
        .flat_map(|state| {
            quantities.iter().map(move |quantity| seen(state.pressure_pa, *quantity, quantity.of(&state)))
        })
        .collect()
}

fn all_of(properties: &[Property]) -> Vec<Unknown> {
    properties.iter().map(|property| Unknown::of(*property, 0)).collect()
}

#[test]
fn exact_bends_of_finite_elements_give_modulus_angle_and_seating_pressure() {
    let all = [Property::ShearModulus, Property::FiberAngle, Property::SeatingPressure];
    for (degrees, start, sought) in [(18.0_f64, 15.0, &all[..]), (5.0, 5.0, &[all[0], all[2]])] {
        let pressures = [20.0, 40.0, 70.0, 100.0, 130.0, 170.0];
        let mut data =
            bends(&bender(0.52e6, sheet(degrees, Families::Two)), None, &[StateQuantity::BendAngle], &pressures);
        data.iter_mut().for_each(|seen| seen.reading_pa += 12e3);
        let body = Body::new("bender", bender(0.4e6, sheet(start, Families::Two)));
        let found = fit(&[body], &data, &all_of(sought), &Settings::default()).unwrap();
        println!("{} steps, {}", found.steps, found.models[0]);
        for estimate in &found.estimates {
            let truth = match estimate.property {
                Property::ShearModulus => 0.52e6,
                Property::FiberAngle => degrees.to_radians(),
                _ => 12e3,
            };
            let error = (estimate.value / truth - 1.0).abs();
            println!("{}: {:e}", estimate.name, error);
            assert!(error < 1e-6, "{}: {} is not {truth}", estimate.name, estimate.value);
        }
        assert!(matches!(found.models[0], BodyModel::SectionFe(Reason::Error(_))), "{:?}", found.models);
    }
}

/// Bends and twists of a helix beside hoops; the analytic bend has no second winding.
#[test]
fn exact_bends_and_twists_give_the_second_winding() {
    let second = |degrees, modulus_pa| Fiber { modulus_pa, ..sheet(degrees, Families::One) };
    let actuator = bender(0.52e6, sheet(5.0, Families::Two));
    let quantities = [StateQuantity::BendAngle, StateQuantity::Twist];
    let data = bends(&actuator, Some(&second(35.0, 4e6)), &quantities, &[30.0, 70.0, 110.0, 150.0]);
    let sought = [Property::ShearModulus, Property::SecondFiberModulus, Property::SecondFiberAngle];
    let body = Body::new("bender", bender(0.45e6, sheet(5.0, Families::Two)));
    let body = body.with_second_fiber(Some(second(38.0, 5e6)));
    let found = fit(&[body], &data, &all_of(&sought), &Settings::default()).unwrap();
    for (estimate, truth) in found.estimates.iter().zip([0.52e6, 4e6, 35f64.to_radians()]) {
        println!("{}: {:e}", estimate.name, (estimate.value / truth - 1.0).abs());
        assert!((estimate.value / truth - 1.0).abs() < 1e-6, "{}: {} is not {truth}", estimate.name, estimate.value);
    }
    assert_eq!(found.models, [BodyModel::SectionFe(Reason::TwoWindings)]);
}

/// The analytic bend leaves out the thread's stretch, and the angle of a winding through the wall.
#[test]
fn fitted_property_that_the_analytic_bend_leaves_out_is_found() {
    let soft = |modulus_pa| Fiber { modulus_pa, ..sheet(10.0, Families::Two) };
    let smeared =
        |degrees: f64| Fiber { placement: Placement::Smeared, modulus_pa: 2e6, ..sheet(degrees, Families::Two) };
    for (property, [truth, start], value) in [
        (Property::FiberModulus, [soft(9e6), soft(12e6)], 9e6),
        (Property::FiberAngle, [smeared(16.0), smeared(13.0)], 16f64.to_radians()),
    ] {
        let data = bends(&bender(0.52e6, truth), None, &[StateQuantity::BendAngle], &[30.0, 60.0, 90.0]);
        let body = Body::new("bender", bender(0.52e6, start));
        let found = fit(&[body], &data, &[Unknown::of(property, 0)], &Settings::default()).unwrap();
        let error = (found.estimates[0].value / value - 1.0).abs();
        println!("{property}: {error:e}");
        assert!(error < 1e-6, "{property}: {}", found.estimates[0].value);
        assert_eq!(found.models, [BodyModel::SectionFe(Reason::LeavesOut(property))]);
    }
}

/// Small bends at the start, where the analytic bend would serve, and large ones at the answer; and more readings than are solved one by one.
#[test]
fn answer_is_by_finite_elements_where_only_the_start_serves_and_for_many_readings() {
    let thin = |shear_modulus_pa| ActuatorParameters {
        inner_radius_m: 5.5e-3,
        ..bender(shear_modulus_pa, sheet(10.0, Families::Two))
    };
    let pressures: Vec<f64> = (1..=30).map(|step| 0.6 * f64::from(step)).collect();
    let data = bends(&thin(0.12e6), None, &[StateQuantity::BendAngle], &pressures);
    let analytic = Actuator::new(&thin(0.6e6)).unwrap().forward(18e3, &Load::none()).unwrap().state;
    let stated = analytic_bend_error(&thin(0.6e6), &analytic).unwrap();
    assert!(stated < BEND_TOLERANCE, "{stated}");
    let body = Body::new("bender", thin(0.6e6));
    let found = fit(&[body], &data, &[Unknown::of(Property::ShearModulus, 0)], &Settings::default()).unwrap();
    let error = (found.estimates[0].value / 0.12e6 - 1.0).abs();
    println!("{error:e} of {} readings, {}", data.len(), found.models[0]);
    assert!(matches!(found.models[0], BodyModel::SectionFe(Reason::Error(_))), "{}", found.models[0]);
    assert!(error < 1e-6, "{error}");
}

/// The derivative is that of wide central differences, extrapolated to no width. Deformations depend on the moduli over the pressure alone, which Euler's
/// theorem makes a sum of three derivatives.
#[test]
fn derivatives_are_those_of_differences_and_of_homogeneity() {
    let parameters = bender(0.52e6, Fiber { modulus_pa: 9e6, ..sheet(25.0, Families::Two) });
    let at = |change: Property, value: f64| {
        let mut body = Body::new("bender", parameters);
        change.place(&mut body, value);
        bends(&body.parameters, None, &[StateQuantity::BendAngle], &[120.0])[0].value
    };
    let data = [seen(120e3, StateQuantity::BendAngle, at(Property::ShearModulus, 0.52e6))];
    // Of one exact reading and one unknown the standard deviation is the accuracy over the derivative.
    let settings = Settings { noise: Noise::AsStated, ..Settings::default() };
    let slope = |property: Property| {
        let found = fit(&[Body::new("bender", parameters)], &data, &[Unknown::of(property, 0)], &settings).unwrap();
        EXACT / found.estimates[0].standard_deviation
    };
    let mut relative = Vec::new();
    for property in [Property::ShearModulus, Property::FiberModulus, Property::FiberAngle, Property::Wall] {
        let value = property.value(&Body::new("bender", parameters)).unwrap();
        let central = |share: f64| {
            (at(property, value * (1.0 + share)) - at(property, value * (1.0 - share))) / (2.0 * share * value)
        };
        let wide = (4.0 * central(0.01) - central(0.02)) / 3.0;
        let found = slope(property).copysign(wide);
        println!("{property}: {found:e} beside {wide:e}");
        assert!((found / wide - 1.0).abs() < 1e-4, "{property}: {found} {wide}");
        relative.push(value * found);
    }
    // A gain of one more takes from the pressure what the moduli would add.
    let by_gain = slope(Property::PressureGain);
    assert!(((relative[0] + relative[1]).abs() / by_gain - 1.0).abs() < 1e-4, "{relative:?} {by_gain}");
    let by_length = slope(Property::Length) * 0.18;
    assert!((by_length / data[0].value - 1.0).abs() < 1e-4, "{by_length}");
}
