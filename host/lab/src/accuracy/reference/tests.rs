//! The reference against programs that are not of this workspace.

use super::*;
use fra_model::{Families, Fiber, Material, Placement};

const DRAGONSKIN_30: Material<f64> = Material::Yeoh { c_pa: [86.56e3, 13.805e3, -1.4661e3] };

fn sample(motion: Motion, radii_mm: [f64; 2], material: Material<f64>, pressure_pa: f64) -> Sample {
    let [inner_radius_m, outer_radius_m] = radii_mm.map(|radius| radius * 1e-3);
    let parameters =
        ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m: 0.1, material, fiber: None };
    Sample { parameters, pressure_pa }
}

fn wound(
    sample: Sample,
    angle_deg: f64,
    families: Families,
    modulus_pa: f64,
    placement: Placement,
    radius_mm: f64,
) -> Sample {
    let fiber = Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa,
        placement,
        thickness_m: 0.178e-3,
        radius_m: radius_mm * 1e-3,
    };
    Sample { parameters: ActuatorParameters { fiber: Some(fiber), ..sample.parameters }, ..sample }
}

/// Axial stretch, inner radius in m and twist in rad.
fn found(sample: &Sample) -> [f64; 3] {
    let truth = Reference::new().truth(sample).expect("an answer");
    let [e, w, g] = truth.deformation.map(Number::nearest);
    let p = &sample.parameters;
    [1.0 + e, p.inner_radius_m * ((1.0 + w) / (1.0 + e)).sqrt(), g * p.length_m / p.inner_radius_m]
}

/// The equilibria of `fra-model/tests/published_and_independent.rs`, which come from a program of its own.
#[test]
fn tubes_are_those_of_an_independent_program() {
    let soft = Material::NeoHookean { shear_modulus_pa: 0.2e6 };
    let firm = Material::NeoHookean { shear_modulus_pa: 0.2226e6 };
    let tube = |radii, material, pressure| sample(Motion::Twisting, radii, material, pressure);
    let cases = [
        (tube([6.0, 8.0], soft, 20e3), [1.00758416808274, 0.00686470133311201, 0.0]),
        (
            wound(tube([6.0, 8.0], firm, 60e3), 3.0, Families::Two, 361e6, Placement::Sheet, 8.0),
            [1.16966589253233, 0.0063319929429134, 0.0],
        ),
        (
            wound(tube([6.0, 9.0], DRAGONSKIN_30, 40e3), 25.0, Families::One, 1e6, Placement::Smeared, 8.0),
            [1.03164917729786, 0.0065842168786434, -1.3265685703988],
        ),
        (
            wound(tube([6.0, 14.0], DRAGONSKIN_30, 80e3), 15.0, Families::Two, 10e6, Placement::Layer, 13.0),
            [1.07912116652509, 0.0068915039749827, 0.0],
        ),
    ];
    for (sample, expected) in cases {
        for (value, expected) in found(&sample).into_iter().zip(expected) {
            assert!((value - expected).abs() <= 1e-11 * expected.abs(), "{value} against {expected}: {sample:?}");
        }
    }
}

/// Of the same file: pressures at given angles.
#[test]
fn bends_are_those_of_an_independent_program() {
    let soft = Material::NeoHookean { shear_modulus_pa: 0.2e6 };
    for (radii, material, winding_mm, angle_rad, pressure_pa) in [
        ([6.0, 8.0], soft, 8.0, 1.0, 38218.7751052344),
        ([5.0, 6.0], Material::NeoHookean { shear_modulus_pa: 0.1e6 }, 6.0, 6.0, 38586.298604646),
    ] {
        let sample = sample(Motion::Bending, radii, material, pressure_pa);
        let sample = wound(sample, 0.0, Families::Two, 0.0, Placement::Sheet, winding_mm);
        let truth = Reference::new().truth(&sample).expect("an answer");
        let off = truth.deformation[0].nearest() - angle_rad;
        assert!(off.abs() < 1e-10 * angle_rad, "{off} rad at {pressure_pa} Pa");
        assert!(truth.doubt.quadrature < 1e-25 && truth.doubt.residual < 1e-25, "{:?}", truth.doubt);
    }
}
