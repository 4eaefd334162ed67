//! Actuators, and a stream of numbers.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use nalgebra::Vector3;
use softlimb_limb::payload::{Bundle, Hold, Mounted};

pub(crate) const SHEAR_MODULUS_PA: f64 = 0.223e6;
pub(crate) const FIBER_MODULUS_PA: f64 = 361e6;
pub(crate) const THICKNESS_M: f64 = 0.178e-3;

/// A stream of numbers in -1 to 1 (splitmix64).
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

pub(crate) fn parameters(angle_deg: f64, families: Families) -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m: 10e-3,
        outer_radius_m: 14e-3,
        length_m: 0.24,
        material: Material::NeoHookean { shear_modulus_pa: SHEAR_MODULUS_PA },
        fiber: Some(Fiber {
            angle_rad: angle_deg.to_radians(),
            families,
            modulus_pa: FIBER_MODULUS_PA,
            placement: Placement::Sheet,
            thickness_m: THICKNESS_M,
            radius_m: 14e-3,
        }),
    }
}

pub(crate) fn straight(
    angle_deg: f64,
    families: Families,
    point: [f64; 3],
    axis: [f64; 3],
    hold: (f64, f64),
) -> Mounted {
    let actuator = Actuator::new(&parameters(angle_deg, families)).unwrap();
    let hold = Hold::Straight { axial_stretch: hold.0, twist_rad: hold.1 };
    Mounted::new("a", actuator, hold, Vector3::from(point), Vector3::from(axis)).unwrap()
}

/// Three extending actuators on a circle, as in the paper's experiments.
pub(crate) fn three(circle_m: f64, stretch: f64) -> Bundle {
    let place = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / 3.0).sin_cos();
        straight(3.0, Families::Two, [circle_m * cos, circle_m * sin, 0.0], [0.0, 0.0, 1.0], (stretch, 0.0))
    };
    Bundle { actuators: (0..3).map(place).collect(), ..Bundle::default() }
}
