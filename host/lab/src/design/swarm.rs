//! The particle swarm of the paper, over geometry and pressures at once: the method that [`search`](softlimb_design::actuators::search) is compared with.

use softlimb_design::actuators::{Answer, DesignError, Objective, Problem, Progress};
use softlimb_numerics::Random;

/// What becomes of a particle that flies out of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faces {
    /// It stays on the face that it would have crossed.
    Nearest,
    /// It is reflected, and its velocity turned.
    Reflective,
    /// That coordinate becomes any within the box.
    Random,
}

/// How a swarm is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swarm {
    /// Seed.
    pub seed: u64,
    /// Particles, at least 1.
    pub particles: usize,
    /// Objectives to be evaluated, at least one for each particle.
    pub evaluations: usize,
    /// Share of its velocity that a particle keeps, `0..1`.
    pub inertia: f64,
    /// Largest pull towards its own best place and towards that of the swarm, > 0.
    pub pull: f64,
    /// Largest velocity, as a share of the box; > 0.
    pub fastest: f64,
    /// What happens at the faces of the box.
    pub faces: Faces,
    /// An objective that is low enough to stop.
    pub enough: f64,
}

impl Default for Swarm {
    /// The coefficients of Clerc and Kennedy, velocities clamped to a fifth of the box.
    fn default() -> Self {
        Self {
            seed: 1,
            particles: 50,
            evaluations: 30_000,
            inertia: 0.7298,
            pull: 1.49618,
            fastest: 0.2,
            faces: Faces::Reflective,
            enough: 0.0,
        }
    }
}

struct Particle {
    at: Vec<f64>,
    velocity: Vec<f64>,
    best: (f64, Vec<f64>),
}

impl Particle {
    fn new(settings: &Swarm, random: &mut Random, objective: &mut Objective) -> Self {
        let width = objective.width();
        let at = random.point(width);
        let velocity = random.point(width).iter().map(|x| settings.fastest * (2.0 * x - 1.0)).collect();
        let value = objective.at(&at).unwrap_or(f64::INFINITY);
        Self { velocity, best: (value, at.clone()), at }
    }

    fn fly(&mut self, settings: &Swarm, leader: &[f64], random: &mut Random, objective: &mut Objective) {
        for (axis, leader) in leader.iter().enumerate() {
            let (x, own) = (self.at[axis], self.best.1[axis]);
            let pull = settings.pull * (random.uniform() * (own - x) + random.uniform() * (leader - x));
            let velocity = settings.inertia * self.velocity[axis] + pull;
            let velocity = velocity.clamp(-settings.fastest, settings.fastest);
            (self.at[axis], self.velocity[axis]) = settings.faces.moved(x, velocity, random);
        }
        let value = objective.at(&self.at).unwrap_or(f64::INFINITY);
        if value < self.best.0 {
            self.best = (value, self.at.clone());
        }
    }
}

impl Faces {
    /// Place and velocity after a move.
    fn moved(self, x: f64, velocity: f64, random: &mut Random) -> (f64, f64) {
        let next = x + velocity;
        if (0.0..=1.0).contains(&next) {
            return (next, velocity);
        }
        match self {
            Self::Nearest => (next.clamp(0.0, 1.0), velocity),
            Self::Reflective => ((if next < 0.0 { -next } else { 2.0 - next }).clamp(0.0, 1.0), -velocity),
            Self::Random => (random.uniform(), velocity),
        }
    }
}

/// Runs a swarm on a design problem. `watch` is told of every round; the solves it is told of leave out those for limit points, which
/// another swarm may not need.
///
/// # Errors
/// As [`solve`](softlimb_design::actuators::solve).
pub fn swarm(problem: &Problem, settings: &Swarm, mut watch: impl FnMut(&Progress)) -> Result<Answer, DesignError> {
    let mut random = Random::new(settings.seed, 0);
    let mut objective = Objective::new(problem);
    let width = objective.width();
    let count = settings.particles.max(1);
    let mut particles: Vec<Particle> =
        (0..count).map(|_| Particle::new(settings, &mut random, &mut objective)).collect();
    let mut leader = (f64::INFINITY, vec![0.5; width]);
    for lap in 1.. {
        for particle in &particles {
            if particle.best.0 < leader.0 {
                leader = particle.best.clone();
            }
        }
        watch(&Progress { objective: leader.0, counts: objective.counts() });
        if (lap + 1) * count > settings.evaluations || leader.0 <= settings.enough {
            break;
        }
        particles.iter_mut().for_each(|particle| particle.fly(settings, &leader.1, &mut random, &mut objective));
    }
    objective.answer(&leader.1, leader.0, settings.seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_stay_in_the_box() {
        let mut random = Random::new(1, 0);
        for faces in [Faces::Nearest, Faces::Reflective, Faces::Random] {
            for (x, velocity) in [(0.9, 0.2), (0.0, -1.0), (0.3, -0.4), (1.0, 3.0), (0.5, 0.1)] {
                let (there, after) = faces.moved(x, velocity, &mut random);
                assert!((0.0..=1.0).contains(&there), "{faces:?} {x} {velocity}: {there}");
                assert_eq!(after.abs(), velocity.abs());
            }
        }
        // 0.9 + 0.2 is as far inside when reflected as it was outside.
        let (there, after) = Faces::Reflective.moved(0.9, 0.2, &mut random);
        assert!((there - 0.9).abs() < 1e-15 && after == -0.2);
        assert_eq!(Faces::Nearest.moved(0.9, 0.2, &mut random).0, 1.0);
    }
}
