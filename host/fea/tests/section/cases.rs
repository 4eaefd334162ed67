//! Actuators that several tests use.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb_fea::cross_section::{Curve, EndLoad, Equilibrium, Options, Section};

/// Neo-Hookean of 0.2 MPa.
pub(crate) const SOFT: Material<f64> = Material::NeoHookean { shear_modulus_pa: 0.2e6 };

/// A Yeoh fit to DragonSkin 30 up to a stretch of two.
pub(crate) const DRAGON_SKIN: Material<f64> = Material::Yeoh { c_pa: [86_560.0, 13_805.0, -1_466.1] };

/// A tube of 100 mm, radii in mm, without fibers.
pub(crate) fn tube(motion: Motion, inner_mm: f64, outer_mm: f64, material: Material<f64>) -> ActuatorParameters<f64> {
    let (inner_radius_m, outer_radius_m) = (inner_mm * 1e-3, outer_mm * 1e-3);
    ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m: 0.1, material, fiber: None }
}

/// Two families for straight motions but twisting, one for that; modulus in units of the shear modulus, sheets 0.1 mm thick.
pub(crate) fn wound(
    tube: ActuatorParameters<f64>,
    angle_deg: f64,
    placement: Placement,
    ratio: f64,
    radius_mm: f64,
) -> ActuatorParameters<f64> {
    let families = if tube.motion == Motion::Twisting { Families::One } else { Families::Two };
    let modulus_pa = ratio * tube.material.shear_modulus_pa();
    let (angle_rad, radius_m) = (angle_deg.to_radians(), radius_mm * 1e-3);
    let fiber = Fiber { angle_rad, families, modulus_pa, placement, thickness_m: 1e-4, radius_m };
    ActuatorParameters { fiber: Some(fiber), ..tube }
}

/// The answers at some pressures.
pub(crate) fn curve(
    parameters: &ActuatorParameters<f64>,
    options: &Options,
    pressures_pa: &[f64],
    load: &EndLoad,
) -> Curve {
    let section = Section::new(parameters, options).expect("valid");
    section.curve(pressures_pa, load).expect("valid")
}

/// The equilibrium at one pressure without load.
pub(crate) fn at(parameters: &ActuatorParameters<f64>, options: &Options, pressure_pa: f64) -> Equilibrium {
    let curve = curve(parameters, options, &[pressure_pa], &EndLoad::default());
    *curve.answers[0].equilibrium().unwrap_or_else(|| panic!("{parameters:?}: {:?}", curve.answers[0]))
}
