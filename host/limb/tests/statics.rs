//! The loaded limb against closed forms, differences, and a shooting solution that shares no code with it.

mod arms;
mod beam;
mod bundles;
mod closed_forms;
mod derivatives;
mod leaning;
mod modes;
mod series;
mod shares;
mod shooting;
mod springs;
mod tiers;
mod tubes;
mod twists;
mod wound;

use nalgebra::{Isometry3, Matrix4, Vector3, Vector4};
use softlimb_limb::statics::{Piece, Rod};

/// Numbers of 0 to 1.
pub(crate) struct Stream(pub(crate) u64);

impl Stream {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// A straight piece of bending stiffness `ei`, all else `stiff` times stiffer.
pub(crate) fn slender(length_m: f64, ei: f64, stiff: f64) -> Piece {
    let axial = stiff * ei / (length_m * length_m);
    Piece {
        free: [1.0, 0.0, 0.0, 0.0],
        free_shear: [0.0; 2],
        stiffness: Matrix4::from_diagonal(&Vector4::new(axial, ei, ei, stiff * ei)),
        coupled: nalgebra::Matrix4x2::zeros(),
        shear_n: axial,
        sway: 0.6,
        length_m,
        mount_angle_rad: 0.0,
        kg_per_m: 0.0,
        rigid_m: 0.0,
        masses: Vec::new(),
    }
}

/// A rod that starts along the scene's first axis, under gravity of 10 m/s2 against the third.
pub(crate) fn level(pieces: Vec<Piece>) -> Rod {
    let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    Rod {
        base: Isometry3::from_parts(nalgebra::Translation3::identity(), turn),
        pieces,
        gravity_m_per_s2: Vector3::new(0.0, 0.0, -10.0),
        tip_force_n: Vector3::zeros(),
    }
}

/// Modules like those of the scenes, with random pressures' shapes, springs, masses, forces and base.
pub(crate) fn random_rod(stream: &mut Stream, load: f64) -> Rod {
    let pieces = (0..3)
        .map(|index| {
            let ei = stream.between(0.4, 1.5);
            let mut stiffness = Matrix4::from_diagonal(&Vector4::new(
                stream.between(600.0, 1500.0),
                ei,
                ei * stream.between(0.7, 1.4),
                stream.between(0.1, 0.5),
            ));
            // A centroid of the stiffness off the axis.
            let off = stream.between(-1.0, 1.0);
            stiffness[(0, 1)] = off;
            stiffness[(1, 0)] = off;
            Piece {
                free: [
                    stream.between(1.0, 1.2),
                    stream.between(-5.0, 5.0),
                    stream.between(-2.0, 2.0),
                    stream.between(-1.0, 1.0),
                ],
                free_shear: [0.0; 2],
                stiffness,
                coupled: nalgebra::Matrix4x2::zeros(),
                shear_n: stream.between(60.0, 300.0),
                sway: 0.6,
                length_m: stream.between(0.15, 0.3),
                mount_angle_rad: stream.between(-3.0, 3.0),
                kg_per_m: load * stream.between(0.5, 1.0),
                rigid_m: 0.02,
                masses: vec![
                    (0.01, load * stream.between(0.05, 0.3)),
                    (0.02, if index == 2 { load * 0.3 } else { 0.0 }),
                ],
            }
        })
        .collect();
    let axis = Vector3::new(stream.between(-1.0, 1.0), stream.between(-1.0, 1.0), stream.between(-1.0, 1.0));
    let mut rod = level(pieces);
    rod.base.rotation = nalgebra::UnitQuaternion::from_scaled_axis(axis * 2.0);
    rod.tip_force_n = axis.yzx() * load;
    rod
}
