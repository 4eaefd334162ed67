//! Random actuators over the whole domain, from a seed.

use fra_model::*;

/// A generator of random numbers (splitmix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed);
        random.bits();
        random
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    pub(crate) fn log_between(&mut self, a: f64, b: f64) -> f64 {
        self.between(a.ln(), b.ln()).exp()
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    pub(crate) fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.bits() % of.len() as u64) as usize]
    }
}

/// An angle from 0 to 90 degrees: anywhere, exactly at an end, or next to an end or a neutral angle.
fn angle_rad(random: &mut Random) -> f64 {
    let right = std::f64::consts::FRAC_PI_2;
    if random.chance(0.05) {
        return random.pick(&[0.0, right]);
    }
    if random.chance(0.15) {
        let special = random.pick(&[0.0, 35.264_389_682_754_654, 54.735_610_317_245_346, 90.0]);
        let off = random.log_between(1e-6, 1.0);
        let sign = if special == 0.0 { 1.0 } else { random.sign() };
        let sign = if special == 90.0 { -1.0 } else { sign };
        return f64::to_radians(special + off * sign);
    }
    random.between(0.0, right)
}

/// Neo-Hookean, or a Yeoh law that stiffens or softens.
fn material(random: &mut Random) -> Material<f64> {
    if random.chance(0.6) {
        return Material::NeoHookean { shear_modulus_pa: random.log_between(1e4, 1e6) };
    }
    let c1 = random.log_between(5e3, 5e5);
    Material::Yeoh { c_pa: [c1, c1 * random.between(-0.02, 0.3), c1 * random.between(-0.02, 0.03)] }
}

/// Radii and length, m: `R_i` 1 to 20 mm, wall 0.005 to 4 of it.
fn tube(random: &mut Random, motion: Motion) -> ActuatorParameters<f64> {
    let inner = random.between(1e-3, 20e-3);
    ActuatorParameters {
        motion,
        inner_radius_m: inner,
        outer_radius_m: inner * (1.0 + random.log_between(0.005, 4.0)),
        length_m: inner * random.log_between(2.0, 100.0),
        material: material(random),
        fiber: None,
    }
}

/// A straight actuator of any winding; `mu2/mu1` 0.1 to 1e6.
pub(crate) fn straight(random: &mut Random) -> ActuatorParameters<f64> {
    let mut p = tube(random, Motion::Extension);
    let (inner, wall) = (p.inner_radius_m, p.outer_radius_m - p.inner_radius_m);
    let families = random.pick(&[Families::One, Families::Two]);
    let placement = random.pick(&[Placement::Sheet, Placement::Layer, Placement::Smeared]);
    let angle = angle_rad(random) * if random.chance(0.2) { -1.0 } else { 1.0 };
    let radius_m = match placement {
        Placement::Sheet if random.chance(0.5) => p.outer_radius_m,
        Placement::Layer => inner + wall * random.between(0.05, 0.95),
        _ => inner + wall * random.unit(),
    };
    p.motion = match families {
        Families::One => Motion::Twisting,
        Families::Two if angle.abs().to_degrees() < 35.3 => Motion::Extension,
        Families::Two => Motion::Expansion,
    };
    p.fiber = Some(Fiber {
        angle_rad: angle,
        families,
        modulus_pa: p.material.shear_modulus_pa() * random.log_between(0.1, 1e6),
        placement,
        thickness_m: wall * random.log_between(0.01, 0.5),
        radius_m,
    });
    p
}

/// A bending actuator, wound at its outer radius or within the wall.
pub(crate) fn bending(random: &mut Random) -> ActuatorParameters<f64> {
    let mut p = tube(random, Motion::Bending);
    p.fiber = random.chance(0.5).then(|| Fiber {
        angle_rad: 0.0,
        families: Families::Two,
        modulus_pa: 1e9,
        placement: Placement::Sheet,
        thickness_m: 1e-4,
        radius_m: random.between(p.inner_radius_m, p.outer_radius_m),
    });
    p
}

/// The same actuator in another scalar.
pub(crate) fn convert<A: Copy, B>(p: &ActuatorParameters<A>, to: impl Fn(A) -> B) -> ActuatorParameters<B> {
    ActuatorParameters {
        motion: p.motion,
        inner_radius_m: to(p.inner_radius_m),
        outer_radius_m: to(p.outer_radius_m),
        length_m: to(p.length_m),
        material: match p.material {
            Material::NeoHookean { shear_modulus_pa } => {
                Material::NeoHookean { shear_modulus_pa: to(shear_modulus_pa) }
            }
            Material::Yeoh { c_pa: [a, b, c] } => Material::Yeoh { c_pa: [to(a), to(b), to(c)] },
        },
        fiber: p.fiber.map(|f| Fiber {
            angle_rad: to(f.angle_rad),
            families: f.families,
            modulus_pa: to(f.modulus_pa),
            placement: f.placement,
            thickness_m: to(f.thickness_m),
            radius_m: to(f.radius_m),
        }),
    }
}
