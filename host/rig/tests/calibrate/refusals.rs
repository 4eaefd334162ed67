//! Data that cannot tell what is asked, and questions that make no sense.

use softlimb_rig::calibrate::{CalibrationError, Fit, Noise, Observation, Property, Settings, Unknown, fit};

use crate::calibrate::tube::{Tube, grid};

/// An accuracy that a good camera has.
const CAMERA: f64 = 1e-3;

fn asked(tube: &Tube, data: &[Observation], properties: &[Property]) -> Result<Fit, CalibrationError> {
    let unknowns: Vec<_> = properties.iter().map(|property| Unknown::of(*property, 0)).collect();
    fit(&[tube.body("arm")], data, &unknowns, &Settings::default())
}

/// Names and text of a refusal for want of information.
fn confused(answer: Result<Fit, CalibrationError>) -> (Vec<String>, String) {
    match answer {
        Err(refusal @ CalibrationError::NotIdentified { .. }) => {
            let text = refusal.to_string();
            let CalibrationError::NotIdentified { names, .. } = refusal else { unreachable!() };
            (names, text)
        }
        other => panic!("{other:?}"),
    }
}

/// With stiff fibers, pressure over modulus is all that counts.
#[test]
fn modulus_and_gain_together_are_refused_and_each_alone_is_found() {
    let tube = Tube { angle: 0.05, fiber_modulus: 361e6, ..Tube::soft() };
    let data = tube.observed(0, &grid(1.02, 1.3, 12), CAMERA);
    let (names, text) = confused(asked(&tube, &data, &[Property::ShearModulus, Property::PressureGain]));
    assert_eq!(names.len(), 2, "{text}");
    assert!(text.contains("shear_modulus of arm") && text.contains("pressure_gain of arm"), "{text}");
    assert!(text.contains("Only their ratio counts"), "{text}");
    for alone in [Property::ShearModulus, Property::PressureGain] {
        asked(&tube, &data, &[alone]).unwrap();
    }
}

#[test]
fn two_unknowns_from_one_point_are_refused_also_when_it_is_repeated() {
    let tube = Tube { angle: 0.05, ..Tube::soft() };
    let point = tube.observed(0, &[1.2], CAMERA)[0];
    let both = [Property::ShearModulus, Property::PressureOffset];
    let few = CalibrationError::TooFewPoints { unknowns: 2, points: 1, needed: 3 };
    assert_eq!(asked(&tube, &[point], &both), Err(few.clone()));
    assert!(few.to_string().contains("3 points are the fewest"), "{few}");
    let (names, text) = confused(asked(&tube, &[point; 20], &both));
    assert_eq!(names.len(), 2, "{text}");
    assert!(text.contains("one without pressure fixes the offset"), "{text}");
}

/// A hoop winding of stiff thread keeps its length: its stretch says nothing about how stiff it is.
#[test]
fn fibers_that_hardly_strain_do_not_tell_their_modulus() {
    let tube = Tube { angle: 0.05, fiber_modulus: 361e6, ..Tube::soft() };
    let data: Vec<_> = tube.observed(0, &grid(1.02, 1.3, 12), CAMERA).into_iter().step_by(2).collect();
    let (names, text) = confused(asked(&tube, &data, &[Property::ShearModulus, Property::FiberModulus]));
    assert_eq!(names, ["fiber_modulus of arm"], "{text}");
    assert!(text.contains("hardly strain"), "{text}");
    // Soft fibers that are pulled at do.
    let tube = Tube { angle: 0.5, fiber_modulus: 1e7, ..tube };
    let data = tube.observed(0, &grid(1.02, 1.14, 12), CAMERA);
    let found = asked(&tube, &data, &[Property::ShearModulus, Property::FiberModulus]).unwrap();
    assert!((found.estimates[1].value / 1e7 - 1.0).abs() < 1e-6, "{:?}", found.estimates);
}

#[test]
fn small_stretches_do_not_tell_the_third_coefficient_and_large_ones_do() {
    let tube = Tube { c: [86_560.0, 13_805.0, -1_466.1], angle: 0.05, fiber_modulus: 40e6, ..Tube::soft() };
    let all = [Property::YeohC1, Property::YeohC2, Property::YeohC3];
    let small = tube.observed(0, &grid(1.02, 1.2, 30), CAMERA);
    let (names, text) = confused(asked(&tube, &small, &all));
    assert!(names.contains(&"yeoh_c3 of arm".to_owned()), "{text}");
    assert!(text.contains("third of about 2"), "{text}");
    let large = tube.observed(0, &grid(1.02, 2.0, 30), CAMERA);
    asked(&tube, &large, &all).unwrap();
}

#[test]
fn questions_that_make_no_sense_are_named() {
    let tube = Tube::soft();
    let data = tube.observed(0, &grid(1.02, 1.2, 4), CAMERA);
    let no_yeoh = asked(&tube, &data, &[Property::YeohC2]).unwrap_err();
    assert_eq!(no_yeoh.to_string(), "arm has no yeoh_c2: its material is neo-Hookean");
    let bodies = [tube.body("arm"), Tube { c: [2e5, 0.0, 0.0], ..tube }.body("hand")];
    let shared = [Unknown { property: Property::ShearModulus, bodies: vec![0, 1] }];
    let different = fit(&bodies, &data, &shared, &Settings::default()).unwrap_err();
    assert!(different.to_string().contains("arm and hand, which start with different ones (200000 and 400000 Pa)"));
    for (bad, expected) in [
        (Observation { accuracy: 0.0, ..data[0] }, "accuracy = 0 of observation 1 is not allowed: finite and > 0"),
        (Observation { value: f64::NAN, ..data[0] }, "value = NaN of observation 1 is not allowed: finite"),
        (
            Observation { reading_pa: f64::INFINITY, ..data[0] },
            "reading_pa = inf of observation 1 is not allowed: finite",
        ),
        (Observation { body: 3, ..data[0] }, "body = 3 of observation 1 is not allowed: an index of the bodies given"),
    ] {
        let unknowns = [Unknown::of(Property::ShearModulus, 0)];
        let found = fit(&bodies, &[bad, data[1], data[2]], &unknowns, &Settings::default()).unwrap_err();
        assert_eq!(found.to_string(), expected);
    }
    let settings = Settings { confidence: 1.0, noise: Noise::AsStated };
    let sure = fit(&bodies, &data, &[Unknown::of(Property::ShearModulus, 0)], &settings).unwrap_err();
    assert_eq!(sure.to_string(), "confidence = 1 of the settings is not allowed: 0.5 to 0.9999");
}

#[test]
fn pressures_beyond_every_limit_point_are_refused_with_the_limit() {
    let tube = Tube { angle: 1.5, fiber_modulus: 40e6, ..Tube::soft() };
    let held = grid(9.2e-3, 10e-3, 3).into_iter().map(|inner| tube.at_inner_radius(inner));
    let mut data = tube.seen(0, held, CAMERA);
    data[0].reading_pa = 900e3;
    let refused = asked(&tube, &data, &[Property::FiberModulus]).unwrap_err();
    assert!(
        matches!(refused, CalibrationError::NoEquilibrium { limit_pa: Some(limit), .. } if limit < 200e3),
        "{refused}"
    );
    assert!(refused.to_string().contains("at 900000 Pa (its limit point is at"), "{refused}");
}
