//! Actuators that the tests share.

#[path = "../../../tests/support/samples.rs"]
mod samples;
pub(crate) mod stresses;

use fra_model::*;

pub(crate) use samples::samples;

pub(crate) const MM: f64 = 1e-3;
pub(crate) const KPA: f64 = 1e3;

pub(crate) fn tube(motion: Motion, inner_mm: f64, outer_mm: f64, material: Material<f64>) -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion,
        inner_radius_m: inner_mm * MM,
        outer_radius_m: outer_mm * MM,
        length_m: 0.1,
        material,
        fiber: None,
    }
}

pub(crate) fn neo_hookean(shear_modulus_pa: f64) -> Material<f64> {
    Material::NeoHookean { shear_modulus_pa }
}

/// DragonSkin 30, three Yeoh coefficients fitted to tension up to a stretch of 2.
pub(crate) const DRAGONSKIN_30: Material<f64> = Material::Yeoh { c_pa: [86.56e3, 13.805e3, -1.4661e3] };

pub(crate) fn wound(
    mut parameters: ActuatorParameters<f64>,
    angle_deg: f64,
    families: Families,
    modulus_pa: f64,
    placement: Placement,
    thickness_mm: f64,
) -> ActuatorParameters<f64> {
    let radius_m = match placement {
        Placement::Layer => parameters.outer_radius_m - thickness_mm * MM,
        Placement::Sheet | Placement::Smeared => parameters.outer_radius_m,
    };
    parameters.fiber = Some(Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa,
        placement,
        thickness_m: thickness_mm * MM,
        radius_m,
    });
    parameters
}

pub(crate) fn solve(parameters: &ActuatorParameters<f64>, pressure_pa: f64) -> Solution<f64> {
    solve_loaded(parameters, pressure_pa, Load::none())
}

pub(crate) fn solve_loaded(parameters: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>) -> Solution<f64> {
    Actuator::new(parameters).expect("valid").forward(pressure_pa, &load).expect("finite")
}

/// The same actuator in single precision.
pub(crate) fn single(p: &ActuatorParameters<f64>) -> ActuatorParameters<f32> {
    p.map(|value| value as f32)
}

pub(crate) fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / b.abs().max(f64::MIN_POSITIVE)
}
