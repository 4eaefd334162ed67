//! Actuators that the tests share: 6 to 8 mm, 60 mm long.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};

/// A tube of one motion; wound with a stiff sheet on its outer face.
pub(crate) fn wound(motion: Motion, angle_deg: f64, families: Families) -> ActuatorParameters<f64> {
    let fiber = Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: 8e-3,
    };
    ActuatorParameters { fiber: Some(fiber), ..plain(motion) }
}

/// The same without a winding.
pub(crate) fn plain(motion: Motion) -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 60e-3,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: None,
    }
}
