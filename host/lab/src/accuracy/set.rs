//! The seeded set of actuators that every method is asked about.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, Status, Target};
use softlimb_numerics::Random;

/// One actuator and the pressure it is asked about. Every number is one that single precision holds exactly, so that both scalars
/// are asked the same question.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The actuator.
    pub parameters: ActuatorParameters<f64>,
    /// Gauge pressure, Pa; a multiple of 10 Pa.
    pub pressure_pa: f64,
}

/// The motions, which the samples take in turn.
pub(super) const MOTIONS: [Motion; 4] = [Motion::Extension, Motion::Expansion, Motion::Twisting, Motion::Bending];

/// Highest pressure asked about, Pa.
const HIGHEST_PRESSURE: f64 = 150e3;
/// Share of the limit pressure that is not exceeded.
const OF_LIMIT: f64 = 0.9;

/// Yeoh coefficients over the first: fits to tension tests of four silicones up to a stretch of 2.
const YEOH_SHAPES: [[f64; 2]; 4] = [[0.1595, -0.0169], [0.2674, -0.0369], [0.2187, -0.0261], [0.0862, -0.0158]];

/// `count` samples of a seed. A sample does not depend on how many follow it.
pub fn samples(seed: u64, count: usize) -> Vec<Sample> {
    let sample = |index: usize| {
        let mut draw = Draw::new(seed, index as u64);
        let motion = MOTIONS[index % MOTIONS.len()];
        loop {
            let parameters = draw.actuator(motion);
            if let Some(pressure_pa) = draw.pressure(&parameters) {
                return Sample { parameters, pressure_pa };
            }
        }
    };
    (0..count).map(sample).collect()
}

struct Draw(Random);

impl Draw {
    fn new(seed: u64, stream: u64) -> Self {
        Self(Random::new(seed, stream))
    }

    fn unit(&mut self) -> f64 {
        self.0.uniform()
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly in the logarithm.
    fn spread(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }

    fn actuator(&mut self, motion: Motion) -> ActuatorParameters<f64> {
        let inner = single(self.between(3e-3, 12e-3));
        let outer = single(inner * (1.0 + self.spread(0.1, 1.0)));
        let material = self.material();
        let mu = material.shear_modulus_pa();
        ActuatorParameters {
            motion,
            inner_radius_m: inner,
            outer_radius_m: outer,
            length_m: single(self.between(60e-3, 200e-3)),
            material,
            fiber: Some(self.fiber(motion, inner, outer, mu)),
        }
    }

    fn material(&mut self) -> Material<f64> {
        let mu = self.spread(30e3, 300e3);
        let shape = YEOH_SHAPES[(self.unit() * 4.0) as usize];
        if self.unit() < 0.5 {
            return Material::NeoHookean { shear_modulus_pa: single(mu) };
        }
        let c1 = single(0.5 * mu);
        Material::Yeoh { c_pa: [c1, single(shape[0] * c1), single(shape[1] * c1)] }
    }

    fn fiber(&mut self, motion: Motion, inner: f64, outer: f64, mu: f64) -> Fiber<f64> {
        let wall = outer - inner;
        let (families, angle_deg) = match motion {
            Motion::Extension => (Families::Two, self.between(0.0, 25.0)),
            Motion::Expansion => (Families::Two, self.between(55.0, 88.0)),
            Motion::Twisting => (Families::One, self.between(10.0, 60.0)),
            Motion::Bending => (Families::Two, 0.0),
        };
        let (kind, ratio, at_surface) = (self.unit(), self.unit(), self.unit() < 0.5);
        let depth = if at_surface { 0.0 } else { self.between(0.0, 0.5) };
        let sheet = single(self.between(0.05e-3, 0.2e-3));
        // Sheet: mu2 t/(mu1 b) from 1 to 1000. Layer and smeared: mu2/mu1.
        let (placement, modulus, radius) = if kind < 0.6 || motion == Motion::Bending {
            (Placement::Sheet, mu * 1000f64.powf(ratio) * wall / sheet, outer - depth * wall)
        } else if kind < 0.8 {
            (Placement::Layer, mu * 3.0 * 100f64.powf(ratio), outer - (0.1 + 0.6 * depth) * wall)
        } else {
            (Placement::Smeared, mu * 30f64.powf(ratio), outer)
        };
        Fiber {
            angle_rad: single(angle_deg.to_radians()),
            families,
            modulus_pa: single(modulus),
            placement,
            thickness_m: sheet,
            radius_m: single(radius).clamp(inner, outer),
        }
    }

    /// A pressure up to the highest, 0.9 of the limit point and, for motions that would go beyond what the elastomers are fitted to,
    /// a stretch of 2 or one turn. `None` where so little is left that the actuator is none.
    fn pressure(&mut self, parameters: &ActuatorParameters<f64>) -> Option<f64> {
        let actuator = Actuator::new(parameters).ok()?;
        let none = Load::none();
        let far = actuator.forward(10.0 * HIGHEST_PRESSURE, &none).ok()?;
        let mut highest = HIGHEST_PRESSURE.min(OF_LIMIT * far.limit_pressure_pa.unwrap_or(f64::INFINITY));
        if parameters.motion == Motion::Bending {
            let turn = actuator.inverse(Target::BendAngle(std::f64::consts::TAU), &none).ok()?;
            let of_limit = turn.limit_pressure_pa.map_or(turn.state.pressure_pa, |limit| OF_LIMIT * limit);
            highest = HIGHEST_PRESSURE.min(of_limit);
        }
        let mut pressure = highest * self.between(0.05, 1.0);
        for _ in 0..20 {
            let state = actuator.forward(pressure, &none).ok().filter(|s| s.status == Status::Solved)?.state;
            let stretched = !(0.5..=2.0).contains(&state.axial_stretch) && parameters.motion != Motion::Bending;
            if !stretched && state.outer_radius_m <= 2.0 * parameters.outer_radius_m {
                break;
            }
            pressure *= 0.7;
        }
        let pressure = (pressure / 10.0).floor() * 10.0;
        (pressure >= 500.0).then_some(pressure)
    }
}

/// The nearest number that single precision holds.
fn single(value: f64) -> f64 {
    f64::from(value as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_repeats_and_a_longer_one_begins_with_a_shorter() {
        let (long, short) = (samples(7, 24), samples(7, 12));
        for (a, b) in long.iter().zip(&short) {
            assert_eq!((a.parameters, a.pressure_pa), (b.parameters, b.pressure_pa));
        }
        assert_ne!(samples(8, 1)[0].parameters, short[0].parameters);
    }

    #[test]
    fn numbers_are_held_by_both_scalars() {
        for sample in samples(1, 40) {
            let p = sample.parameters;
            let fiber = p.fiber.expect("wound");
            let numbers = [p.inner_radius_m, p.outer_radius_m, p.length_m, fiber.angle_rad, fiber.modulus_pa];
            for number in numbers.into_iter().chain([fiber.radius_m, fiber.thickness_m, sample.pressure_pa]) {
                assert_eq!(number, single(number));
            }
            assert!(p.check().is_ok() && sample.pressure_pa <= HIGHEST_PRESSURE);
        }
    }
}
