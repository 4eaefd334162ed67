//! Problems by kind and seed, to measure methods on.
//!
//! | kind | actuators | numbers to find | wanted |
//! | --- | --- | --- | --- |
//! | P1 | 3 of one geometry on a circle | 17 | four wrenches that some bundle within the bounds has |
//! | P1u | the same | 17 | twice to four times such wrenches: beyond what any bundle can |
//! | P2 | 6, each of its own, with free place and tilt | 72 | four wrenches that some bundle has |

use std::f64::consts::TAU;

use fra_model::{Families, Material, Placement};

use softlimb_design::actuators::Winding;
use softlimb_design::bundle::{Attachment, ForceProblem, Forces, Place, Sample, Tube};
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::LeastSquares;

/// The kinds.
pub const KINDS: [&str; 3] = ["P1", "P1u", "P2"];

const SAMPLES: usize = 4;

/// A problem of a kind; `None` for a name that is no kind.
pub fn kind(name: &str, seed: u64) -> Option<ForceProblem> {
    let stream = KINDS.iter().position(|known| *known == name)? as u64;
    let free = name == "P2";
    let count = if free { 6 } else { 3 };
    let attachment = |i: usize| {
        let azimuth = TAU * i as f64 / count as f64;
        let slope = if free { [-0.3, 0.3] } else { [0.0; 2] };
        Attachment {
            name: format!("actuator {}", i + 1),
            tube: tube(),
            place: Place::Polar {
                radius_m: [0.025, 0.05],
                azimuth_rad: if free { [azimuth - 0.5, azimuth + 0.5] } else { [azimuth; 2] },
            },
            height_m: [0.0; 2],
            slopes: [slope; 2],
        }
    };
    let sample = |_| Sample { wrench: [0.0; 6], held_length_m: Some(0.24) };
    let mut problem = ForceProblem {
        shared: !free,
        actuators: (0..count).map(attachment).collect(),
        samples: (0..SAMPLES).map(sample).collect(),
        force_per_n: 1.0,
        torque_per_nm: 20.0,
        effort: 0.0,
        reference_pressure_pa: None,
    };
    let mut random = Random::new(seed, stream);
    let wrenches = loop {
        let mut forces = Forces::new(&problem);
        let place: Vec<f64> = random.point(forces.width()).iter().map(|x| 0.1 + 0.8 * x).collect();
        if let Some(point) = forces.evaluate(&place) {
            break point.wrenches;
        }
    };
    for (sample, wrench) in problem.samples.iter_mut().zip(wrenches) {
        let size = if name == "P1u" { 2.0 + 2.0 * random.uniform() } else { 1.0 };
        sample.wrench = (wrench * size).into();
        if name == "P1u" {
            // More than the largest push of the bounds along the axis.
            sample.wrench[2] = sample.wrench[2].abs().max(450.0);
        }
    }
    Some(problem)
}

fn tube() -> Tube {
    Tube {
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        winding: Winding {
            families: Families::Two,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            wall_share: 1.0,
        },
        mirrored: false,
        inner_radius_m: [0.006, 0.012],
        wall_m: [0.003, 0.006],
        length_m: [0.2, 0.24],
        angle_rad: [0.0, 30.0_f64.to_radians()],
        pressure_max_pa: 120e3,
    }
}
