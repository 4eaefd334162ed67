//! Random bodies and solids.

use fra_model::Segment;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use softlimb_scene::collision::{Body, Shape};

/// What a body is made of: modules with mount angle and radius, and the rigid part behind each with its radius.
pub(crate) struct Parts {
    pub(crate) base: Isometry3<f64>,
    pub(crate) modules: Vec<(Segment<f64>, f64, f64)>,
    pub(crate) rigid: Vec<(f64, f64)>,
}

impl Parts {
    pub(crate) fn body(&self) -> Body {
        let mut body = Body::new(&self.base);
        for ((segment, mount, radius), (length, rigid_radius)) in self.modules.iter().zip(&self.rigid) {
            body.module(segment, *mount, *radius);
            body.rigid(*length, *rigid_radius);
        }
        body
    }
}

pub(crate) struct Random(ChaCha8Rng);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub(crate) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn point(&mut self, extent: f64) -> [f64; 3] {
        [(); 3].map(|()| self.between(-extent, extent))
    }

    pub(crate) fn rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(Vector3::from(self.point(3.0)))
    }

    pub(crate) fn shape(&mut self, extent: f64) -> Shape {
        let center = self.point(extent);
        match self.between(0.0, 3.0) as u32 {
            0 => Shape::sphere(center, self.between(0.005, 0.15)),
            1 => Shape::capsule(center, self.point(extent), self.between(0.005, 0.1)),
            _ => {
                let half = [(); 3].map(|()| self.between(0.005, 0.2));
                Shape::cuboid(center, half, self.rotation())
            }
        }
        .unwrap()
    }

    pub(crate) fn parts(&mut self) -> Parts {
        let base = Isometry3::from_parts(Translation3::from(Vector3::from(self.point(0.2))), self.rotation());
        let count = 1 + self.between(0.0, 3.0) as usize;
        let module = |random: &mut Self| {
            let kind = random.between(0.0, 4.0) as u32;
            let bend = if kind >= 2 { random.between(0.0, 3.5) } else { 0.0 };
            let twist = if kind == 1 || kind == 3 { random.between(-3.0, 3.0) } else { 0.0 };
            let length_m = random.between(0.05, 0.4);
            let segment = Segment { length_m, bend_angle_rad: bend, twist_rad: twist };
            (segment, random.between(-3.0, 3.0), random.between(0.0, 0.05))
        };
        let modules = (0..count).map(|_| module(self)).collect();
        let rigid = (0..count).map(|_| (self.between(0.0, 0.1), self.between(0.0, 0.05))).collect();
        Parts { base, modules, rigid }
    }
}
