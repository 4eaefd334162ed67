//! Actuators of the queries.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement, State, Target};

/// One actuator and the pressure of its queries.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) parameters: ActuatorParameters<f32>,
    /// Gauge pressure, Pa.
    pub(crate) pressure_pa: f32,
}

impl Case {
    /// The deformation by which a state of this actuator is named in an inverse problem.
    pub(crate) fn target(&self, state: &State<f32>) -> Target<f32> {
        match self.parameters.motion {
            Motion::Extension => Target::AxialStretch(state.axial_stretch),
            Motion::Expansion => Target::OuterRadius(state.outer_radius_m),
            Motion::Bending => Target::BendAngle(state.bend_angle_rad),
            Motion::Twisting => Target::Twist(state.twist_rad),
        }
    }
}

const NEO_HOOKEAN: Material<f32> = Material::NeoHookean { shear_modulus_pa: 0.223e6 };
const YEOH: Material<f32> = Material::Yeoh { c_pa: [0.11e6, 2.0e3, 30.0] };
const DEGREE: f32 = core::f32::consts::PI / 180.0;

/// A sheet of aramid thread; the same as in the scenes.
pub(crate) const fn sheet(degrees: f32, families: Families) -> Option<Fiber<f32>> {
    Some(Fiber {
        angle_rad: degrees * DEGREE,
        families,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: 14e-3,
    })
}

/// Soft threads all through the wall.
const fn smeared(degrees: f32) -> Option<Fiber<f32>> {
    Some(Fiber {
        angle_rad: degrees * DEGREE,
        families: Families::Two,
        modulus_pa: 1e6,
        placement: Placement::Smeared,
        thickness_m: 0.0,
        radius_m: 12e-3,
    })
}

const fn case(
    name: &'static str,
    motion: Motion,
    material: Material<f32>,
    fiber: Option<Fiber<f32>>,
    pressure_pa: f32,
) -> Case {
    let parameters =
        ActuatorParameters { motion, inner_radius_m: 10e-3, outer_radius_m: 14e-3, length_m: 0.24, material, fiber };
    Case { name, parameters, pressure_pa }
}

/// One of each motion as in the scenes, and one of each other law.
pub(crate) const CASES: [Case; 7] = [
    case("extension, sheet", Motion::Extension, NEO_HOOKEAN, sheet(3.0, Families::Two), 40e3),
    case("expansion, sheet", Motion::Expansion, NEO_HOOKEAN, sheet(80.0, Families::Two), 20e3),
    case("twisting, sheet", Motion::Twisting, NEO_HOOKEAN, sheet(28.0, Families::One), 20e3),
    case("bending", Motion::Bending, NEO_HOOKEAN, None, 20e3),
    case("extension, smeared", Motion::Extension, NEO_HOOKEAN, smeared(20.0), 30e3),
    case("extension, Yeoh", Motion::Extension, YEOH, sheet(3.0, Families::Two), 40e3),
    case("bending, Yeoh", Motion::Bending, YEOH, None, 20e3),
];
