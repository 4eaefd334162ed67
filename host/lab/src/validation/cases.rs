//! The published set of actuators.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb::comparison::Case;

/// Sizes: inner and outer radius and length, m.
const SIZES: [[f64; 3]; 2] = [[6e-3, 8e-3, 60e-3], [10e-3, 14e-3, 100e-3]];

/// Dragon Skin 30: fits to tension up to a stretch of 2 (`docs/explanation/model.md`), neo-Hookean and Yeoh.
const MATERIALS: [(&str, Material<f64>); 2] = [
    ("neo-Hookean", Material::NeoHookean { shear_modulus_pa: 0.223e6 }),
    ("Yeoh", Material::Yeoh { c_pa: [86.56e3, 13.805e3, -1466.1] }),
];

/// Motion, fiber angle, families, and the highest pressure over `2 C1 ln(R_o/R_i)`: far below the limit point of an expanding one.
const MOTIONS: [(Motion, &str, f64, Families, f64); 4] = [
    (Motion::Extension, "extension", 3.0, Families::Two, 0.9),
    (Motion::Expansion, "expansion", 85.0, Families::Two, 0.7),
    (Motion::Bending, "bending", 3.0, Families::Two, 0.9),
    (Motion::Twisting, "twisting", 30.0, Families::One, 0.6),
];

/// Pressures of a case.
const PRESSURES: usize = 6;

/// The set: four motions in two sizes and two materials, wound with thread as a sheet on the outer surface.
pub fn cases() -> Vec<Case> {
    let of_motion = |motion| MATERIALS.map(|material| SIZES.map(|size| case(motion, material, size)));
    MOTIONS.into_iter().flat_map(of_motion).flatten().collect()
}

fn case(
    (motion, name, angle_deg, families, share): (Motion, &str, f64, Families, f64),
    (law, material): (&str, Material<f64>),
    [inner_radius_m, outer_radius_m, length_m]: [f64; 3],
) -> Case {
    // Two layers of Kevlar thread every 3 mm, as in the scenes.
    let (modulus_pa, thickness_m, placement) = (361e6, 0.178e-3, Placement::Sheet);
    let angle_rad = f64::to_radians(angle_deg);
    let fiber = Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m: outer_radius_m };
    let highest_pa = share * material.shear_modulus_pa() * (outer_radius_m / inner_radius_m).ln();
    let step_kpa = (highest_pa * 1e-3 / PRESSURES as f64).round();
    Case {
        name: format!("{name}, {}/{} mm, {law}", inner_radius_m * 1e3, outer_radius_m * 1e3),
        parameters: ActuatorParameters {
            motion,
            inner_radius_m,
            outer_radius_m,
            length_m,
            material,
            fiber: Some(fiber),
        },
        second_fiber: None,
        pressures_pa: (1..=PRESSURES).map(|k| 1e3 * step_kpa * k as f64).collect(),
    }
}
