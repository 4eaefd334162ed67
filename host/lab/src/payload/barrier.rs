//! The paper's method for eq. (18): Broyden, Fletcher, Goldfarb and Shanno with a logarithmic barrier for the bounds, derivatives by
//! differences. It is here to be compared with.
//!
//! ```text
//! minimise  f(x) - mu sum_j (ln x_j + ln(1 - x_j))      mu = 10, 1, ... 1e-8
//! ```

use nalgebra::{DMatrix, DVector};

use softlimb_design::bundle::{Answer, ForceProblem, Forces};
use softlimb_limb::payload::PayloadError;
use softlimb_numerics::Random;
use softlimb_numerics::least_squares::{LeastSquares, sum_of_squares};

/// Settings of the method.
#[derive(Clone, Copy, Debug)]
pub struct Barrier {
    /// Seed of the start; 0 for the middle of the box.
    pub seed: u64,
    /// First and last weight of the barrier.
    pub weights: [f64; 2],
    /// Factor from one weight to the next.
    pub factor: f64,
    /// Most steps at one weight.
    pub steps: usize,
    /// Step of the differences, of the box.
    pub difference: f64,
}

impl Default for Barrier {
    fn default() -> Self {
        Self { seed: 0, weights: [10.0, 1e-8], factor: 0.1, steps: 200, difference: 1e-7 }
    }
}

/// Solves eq. (18) as the paper does.
///
/// # Errors
/// As [`search`](softlimb_design::bundle::search()).
pub fn barrier(problem: &ForceProblem, settings: &Barrier) -> Result<Answer, PayloadError> {
    let mut forces = Forces::new(problem);
    let width = forces.width();
    // Away from the faces, where the barrier is infinite.
    let start = match settings.seed {
        0 => vec![0.5; width],
        seed => Random::new(seed, 0).point(width).iter().map(|x| 0.05 + 0.9 * x).collect(),
    };
    let mut place = DVector::from_vec(start);
    let mut weight = settings.weights[0];
    while weight >= 0.999 * settings.weights[1] {
        place = descend(&mut forces, place, weight, settings);
        weight *= settings.factor;
    }
    forces.answer(place.as_slice())
}

fn value(forces: &mut Forces<'_>, place: &DVector<f64>, weight: f64) -> f64 {
    if place.iter().any(|x| !(*x > 0.0 && *x < 1.0)) {
        return f64::INFINITY;
    }
    let walls: f64 = place.iter().map(|x| x.ln() + (1.0 - x).ln()).sum();
    match forces.evaluate(place.as_slice()) {
        Some(point) => sum_of_squares(&forces.residuals(&point)) - weight * walls,
        None => f64::INFINITY,
    }
}

fn gradient(forces: &mut Forces<'_>, place: &DVector<f64>, here: f64, weight: f64, step: f64) -> DVector<f64> {
    DVector::from_fn(place.len(), |j, _| {
        let mut there = place.clone();
        // Inwards, and not through a face.
        let step = step.min(0.5 * place[j].min(1.0 - place[j])) * if place[j] < 0.5 { 1.0 } else { -1.0 };
        there[j] += step;
        (value(forces, &there, weight) - here) / step
    })
}

fn descend(forces: &mut Forces<'_>, mut place: DVector<f64>, weight: f64, settings: &Barrier) -> DVector<f64> {
    let width = place.len();
    let mut inverse = DMatrix::identity(width, width);
    let mut here = value(forces, &place, weight);
    let mut slope = gradient(forces, &place, here, weight, settings.difference);
    for _ in 0..settings.steps {
        let mut direction = -(&inverse * &slope);
        if direction.dot(&slope) >= 0.0 {
            inverse = DMatrix::identity(width, width);
            direction = -&slope;
        }
        let promised = direction.dot(&slope);
        let mut part = 1.0;
        let next = loop {
            let there = &place + &direction * part;
            let reached = value(forces, &there, weight);
            if reached <= here + 1e-4 * part * promised {
                break Some((there, reached));
            }
            part *= 0.5;
            if part < 1e-14 {
                break None;
            }
        };
        let Some((there, reached)) = next else { break };
        let new = gradient(forces, &there, reached, weight, settings.difference);
        let (moved, turned) = (&there - &place, &new - &slope);
        let gained = here - reached;
        let along = moved.dot(&turned);
        if along > 1e-14 * moved.norm() * turned.norm() {
            let identity = DMatrix::identity(width, width);
            let left = &identity - &moved * turned.transpose() / along;
            inverse = &left * &inverse * left.transpose() + &moved * moved.transpose() / along;
        }
        (place, here, slope) = (there, reached, new);
        if gained <= 1e-15 * here.abs() || slope.norm() <= 1e-9 * weight.sqrt() {
            break;
        }
    }
    place
}
