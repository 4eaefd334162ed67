//! The polynomial that stands for the section's bend.

use fra_model::{Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Limiter, Mesh, Options, Section, SectionError};

use crate::section::cases::{DRAGON_SKIN, SOFT, tube, wound};

const STRIP: Limiter = Limiter::Strip { half_angle_rad: 0.26, stiffness_n_per_m: 1e5 };

/// Sizes, materials, windings and limiting layers with the pressures they work at.
fn sections() -> Vec<(Section, [f64; 2])> {
    let mesh = Mesh { radial: 2, around: 12 };
    let mut all = Vec::new();
    for (inner, outer, low, high) in [(6.0, 7.0, 4e3, 40e3), (6.0, 8.0, 8e3, 80e3), (4.0, 6.0, 10e3, 100e3)] {
        for material in [SOFT, DRAGON_SKIN] {
            let bare = tube(Motion::Bending, inner, outer, material);
            let crossed = wound(bare, 5.0, Placement::Sheet, 3000.0, outer);
            for (parameters, limiter) in [(bare, Limiter::Line), (crossed, STRIP)] {
                let options = Options { limiter: Some(limiter), mesh, ..Options::default() };
                all.push((Section::new(&parameters, &options).expect("valid"), [low, high]));
            }
        }
    }
    all
}

/// Over a tenfold range of pressures, up to bends of 139 to 198 degrees in 100 mm.
#[test]
fn the_bend_is_a_cubic_of_the_rate_to_half_a_percent() {
    let mut worst = 0.0;
    for (section, range) in sections() {
        let calibration = section.calibrate(range).expect("it bends");
        println!("{range:?}: {:.2e} at {:.0} Pa", calibration.verified_error, calibration.worst_pressure_pa);
        assert!(calibration.verified_error < 5e-3, "{calibration:?}");
        assert!(calibration.mesh_error < 3e-3, "{calibration:?}");
        worst = f64::max(worst, calibration.verified_error);
    }
    println!("largest verified error: {worst:.1e}");
}

/// Solves at pressures that the calibration has not seen keep what it says.
#[test]
fn the_verified_error_holds_in_between() {
    for (section, [low, high]) in sections() {
        let calibration = section.calibrate([low, high]).expect("it bends");
        let pressures: Vec<f64> = (0..23).map(|i| low + (high - low) * (0.013 + 0.0425 * f64::from(i))).collect();
        let curve = section.curve(&pressures, &EndLoad::default()).expect("valid");
        for answer in &curve.answers {
            let rate = answer.equilibrium().expect("within the range").state.bend_rates_rad_per_m[0];
            let found = calibration.polynomial.bend_rate_rad_per_m(answer.pressure_pa);
            let error = (found / rate - 1.0).abs();
            assert!(error < 1.1 * calibration.verified_error, "{error} at {} of {calibration:?}", answer.pressure_pa);
        }
    }
}

#[test]
fn pressure_and_bend_rate_are_inverse() {
    let (section, range) = sections().swap_remove(0);
    let polynomial = section.calibrate(range).expect("it bends").polynomial;
    for pressure in [range[0], 17e3, range[1]] {
        let back = polynomial.pressure_pa(polynomial.bend_rate_rad_per_m(pressure));
        assert!((back / pressure - 1.0).abs() < 1e-12, "{back} {pressure}");
    }
}

#[test]
fn straight_motions_have_no_polynomial() {
    let straight = Section::new(&tube(Motion::Extension, 6.0, 8.0, SOFT), &Options::default()).expect("valid");
    let error = straight.calibrate([5e3, 40e3]).expect_err("it stays straight");
    assert!(matches!(error, SectionError::NoBend { reason: "the actuator does not bend", .. }), "{error}");
    let error = straight.calibrate([5e3, 80e3]).expect_err("beyond its limit");
    assert!(matches!(error, SectionError::NoBend { .. }), "{error}");
    for (range, field) in
        [([0.0, 1e3], "pressures_pa[0]"), ([1e3, 1.2e3], "pressures_pa[1]"), ([1e3, f64::NAN], "pressures_pa[1]")]
    {
        assert!(straight.calibrate(range).expect_err("out of range").to_string().starts_with(field));
    }
}
