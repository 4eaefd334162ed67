//! What is refused, and how it is said.

use fra_model::{Fiber, Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Limiter, Mesh, Options, Section};

use crate::section::cases::{SOFT, tube, wound};

fn complaint(options: &Options) -> String {
    let parameters = tube(Motion::Bending, 6.0, 8.0, SOFT);
    Section::new(&parameters, options).expect_err("out of range").to_string()
}

#[test]
fn meshes_out_of_range_are_named() {
    for (radial, around, text) in [
        (3, 16, "mesh.radial = 3 is not allowed: even, 2 to 128"),
        (0, 16, "mesh.radial = 0 is not allowed: even, 2 to 128"),
        (4, 2, "mesh.around = 2 is not allowed: even, 4 to 128"),
        (4, 100_000, "mesh.around = 100000 is not allowed: even, 4 to 128"),
    ] {
        assert_eq!(complaint(&Options { mesh: Mesh { radial, around }, ..Options::default() }), text);
    }
}

#[test]
fn strips_out_of_range_are_named() {
    for (half_angle_rad, stiffness_n_per_m, field) in [
        (0.0, 1e5, "half_angle_rad"),
        (2.0, 1e5, "half_angle_rad"),
        (f64::NAN, 1e5, "half_angle_rad"),
        (0.3, 0.0, "stiffness_n_per_m"),
        (0.3, f64::INFINITY, "stiffness_n_per_m"),
    ] {
        let limiter = Some(Limiter::Strip { half_angle_rad, stiffness_n_per_m });
        assert!(complaint(&Options { limiter, ..Options::default() }).starts_with(field));
    }
}

#[test]
fn actuators_are_checked_as_the_model_checks_them() {
    let mut parameters = tube(Motion::Bending, 6.0, 8.0, SOFT);
    parameters.outer_radius_m = 5e-3;
    let error = Section::new(&parameters, &Options::default()).expect_err("inside out");
    assert_eq!(error.to_string(), "outer_radius_m = 0.005 is not allowed: finite and > inner_radius_m");
}

/// The analytic model of bending does not look at the sheet's thickness, this one does.
#[test]
fn winding_of_a_bending_actuator_needs_what_is_computed_with() {
    let mut parameters = wound(tube(Motion::Bending, 6.0, 8.0, SOFT), 5.0, Placement::Sheet, 10.0, 8.0);
    parameters.fiber = parameters.fiber.map(|fiber| Fiber { thickness_m: 0.0, ..fiber });
    let error = Section::new(&parameters, &Options::default()).expect_err("no thickness");
    assert_eq!(error.to_string(), "thickness_m = 0 is not allowed: finite and > 0");
}

#[test]
fn pressures_and_loads_out_of_range_are_named() {
    let section = Section::new(&tube(Motion::Bending, 6.0, 8.0, SOFT), &Options::default()).expect("valid");
    for pressure in [-1.0, f64::NAN, f64::INFINITY, 1e9] {
        let error = section.curve(&[1e3, pressure], &EndLoad::default()).expect_err("out of range").to_string();
        assert!(error.starts_with("pressures_pa = "), "{error}");
    }
    let load = EndLoad { bending_moments_nm: [0.0, f64::NAN], ..EndLoad::default() };
    let error = section.curve(&[1e3], &load).expect_err("out of range").to_string();
    assert_eq!(error, "bending_moments_nm[1] = NaN is not allowed: finite");
}

#[test]
fn answers_come_in_the_order_asked() {
    let section = Section::new(&tube(Motion::Bending, 6.0, 8.0, SOFT), &Options::default()).expect("valid");
    let pressures = [30e3, 0.0, 10e3, 30e3];
    let curve = section.curve(&pressures, &EndLoad::default()).expect("valid");
    let rates: Vec<f64> = curve
        .answers
        .iter()
        .map(|answer| answer.equilibrium().expect("stable").state.bend_rates_rad_per_m[0])
        .collect();
    assert!(curve.answers.iter().zip(pressures).all(|(answer, pressure)| answer.pressure_pa == pressure));
    assert!(rates[0] == rates[3] && rates[0] > rates[2] && rates[2] > rates[1].abs(), "{rates:?}");
    assert!(section.curve(&[], &EndLoad::default()).expect("valid").answers.is_empty());
}
