//! The particle swarm of the paper, over geometry and pressures at once: the method that [`search`](super::search) is compared with.
//!
//! Constriction coefficients of Clerc and Kennedy, velocities clamped to a fifth of the box, and particles that are reflected at its
//! faces. A pressure is a share of the highest one of its geometry, so that no particle is ever beyond a limit point.

use super::actuator::{Candidate, Counts};
use super::answer::{Answer, DesignError, confirm};
use super::problem::Problem;
use super::search::{Found, Random, Starts};

const INERTIA: f64 = 0.7298;
const PULL: f64 = 1.49618;
const FASTEST: f64 = 0.2;

/// How a swarm is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Swarm {
    /// Seed.
    pub seed: u64,
    /// Particles, at least 1.
    pub particles: usize,
    /// Objectives to be evaluated, at least one for each particle.
    pub evaluations: usize,
}

impl Default for Swarm {
    fn default() -> Self {
        Self { seed: 1, particles: 50, evaluations: 30_000 }
    }
}

struct Objective<'a> {
    problem: &'a Problem,
    counts: Counts,
}

impl Objective<'_> {
    fn width(&self) -> usize {
        let geometry: usize = self.problem.segments.iter().map(|segment| segment.dimensions()).sum();
        let lines = if self.problem.shared_pressure { 1 } else { self.problem.segments.len() };
        geometry + lines * self.problem.phases()
    }

    /// Splits a particle into places and pressures of the segments.
    fn parts(&mut self, particle: &[f64]) -> Option<Vec<(Vec<f64>, Vec<f64>)>> {
        let phases = self.problem.phases();
        let (mut rest, mut geometries) = (particle, Vec::new());
        for segment in &self.problem.segments {
            let (place, others) = rest.split_at(segment.dimensions());
            let cap = Candidate::new(segment, place)?.cap(&mut self.counts)?;
            geometries.push((place.to_vec(), cap.pressure_pa));
            rest = others;
        }
        let least = geometries.iter().map(|(_, cap)| *cap).fold(f64::INFINITY, f64::min);
        let shared = self.problem.shared_pressure;
        let with_pressures = |(index, (place, cap)): (usize, (Vec<f64>, f64))| {
            let (first, cap) = if shared { (0, least) } else { (index * phases, cap) };
            (place, rest[first..first + phases].iter().map(|share| share * cap).collect())
        };
        Some(geometries.into_iter().enumerate().map(with_pressures).collect())
    }

    fn at(&mut self, particle: &[f64]) -> Option<f64> {
        self.counts.evaluations += 1;
        let mut sum = 0.0;
        for (segment, (place, pressures)) in self.problem.segments.iter().zip(self.parts(particle)?) {
            let candidate = Candidate::new(segment, &place)?;
            for (goal, pressure_pa) in segment.goals.iter().zip(pressures) {
                let Some(goal) = goal else { continue };
                let found = candidate.measure(&candidate.at(pressure_pa, &mut self.counts)?);
                sum += goal.weight * (found - goal.value).powi(2);
            }
        }
        Some(sum)
    }
}

struct Particle {
    at: Vec<f64>,
    velocity: Vec<f64>,
    best: (f64, Vec<f64>),
}

impl Particle {
    fn new(width: usize, random: &mut Random, objective: &mut Objective) -> Self {
        let at = random.place(width);
        let velocity = random.place(width).iter().map(|x| FASTEST * (2.0 * x - 1.0)).collect();
        let value = objective.at(&at).unwrap_or(f64::INFINITY);
        Self { velocity, best: (value, at.clone()), at }
    }

    fn fly(&mut self, leader: &[f64], random: &mut Random, objective: &mut Objective) {
        for (axis, leader) in leader.iter().enumerate() {
            let (x, own) = (self.at[axis], self.best.1[axis]);
            let pull = PULL * (random.uniform() * (own - x) + random.uniform() * (leader - x));
            let velocity = (INERTIA * self.velocity[axis] + pull).clamp(-FASTEST, FASTEST);
            let next = x + velocity;
            let inside = (0.0..=1.0).contains(&next);
            self.velocity[axis] = if inside { velocity } else { -velocity };
            self.at[axis] = if next < 0.0 {
                -next
            } else if next > 1.0 {
                2.0 - next
            } else {
                next
            };
        }
        let value = objective.at(&self.at).unwrap_or(f64::INFINITY);
        if value < self.best.0 {
            self.best = (value, self.at.clone());
        }
    }
}

/// Runs a swarm on a design problem. `round` is told of every round.
///
/// # Errors
/// As [`solve`](super::solve).
pub fn swarm(problem: &Problem, settings: &Swarm, mut round: impl FnMut(usize, f64)) -> Result<Answer, DesignError> {
    let mut random = Random::new(settings.seed, 0);
    let mut objective = Objective { problem, counts: Counts::default() };
    let width = objective.width();
    let count = settings.particles.max(1);
    let mut particles: Vec<Particle> = (0..count).map(|_| Particle::new(width, &mut random, &mut objective)).collect();
    let mut leader = (f64::INFINITY, vec![0.5; width]);
    for lap in 1.. {
        for particle in &particles {
            if particle.best.0 < leader.0 {
                leader = particle.best.clone();
            }
        }
        round(lap * count, leader.0);
        if (lap + 1) * count > settings.evaluations {
            break;
        }
        particles.iter_mut().for_each(|particle| particle.fly(&leader.1, &mut random, &mut objective));
    }
    let nowhere = || DesignError::NoEquilibrium { segment: problem.segments[0].name.clone() };
    let parts = objective.parts(&leader.1).ok_or_else(nowhere)?;
    let starts = Starts { made: 1, agreeing: 1 };
    let found = |(place, pressures_pa)| Found { place, pressures_pa, starts, counts: Counts::default() };
    let parts: Vec<Found> = parts.into_iter().map(found).collect();
    confirm(problem, &parts, objective.counts, settings.seed)
}
