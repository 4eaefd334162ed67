//! Both routes side by side, for each pose.

use nalgebra::Vector3;

use super::input::Varied;
use super::linear::Linear;
use super::sample::{Deviation, Sample};
use softlimb_numerics::statistics::{Estimate, mean, percentile};

/// Up to this share of the displacement's RMS the linear route may be off from limb to limb, RMS, and still count as enough. What is
/// left out being of second order, the RMS itself is then off by about half of its square, 0.5 %.
const ENOUGH: f64 = 0.1;
/// Displacements below this, m, are rounding.
const NOTHING_M: f64 = 1e-12;

/// What is left of the mean square of the displacement where only some parameters are off, as a share of the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// What is off.
    pub varied: Varied,
    /// By the linear route.
    pub linear: f64,
    /// By the samples.
    pub sampled: Estimate,
}

/// What happens to the tip in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseStatistics {
    /// Samples with an answer.
    pub answered: usize,
    /// Samples without one by the first module that has no equilibrium, in the order of the modules.
    pub lost: Vec<usize>,
    /// RMS displacement by the linear route, m.
    pub linear_rms_m: f64,
    /// That of the samples, m.
    pub rms_m: Estimate,
    /// Displacement that 95 % of the limbs do not exceed, m: by the linear route for the same limbs, and by the model.
    pub p95_m: [f64; 2],
    /// Largest displacement of the samples, m.
    pub max_m: f64,
    /// Mean of the displacement of the samples, m.
    pub mean_m: Vector3<f64>,
    /// RMS distance of the two routes, limb by limb, m.
    pub departure_m: f64,
    /// Shares of the mean square, in the order of [`Varied::all`]; none where the tip does not move.
    pub shares: Vec<Share>,
}

/// What happens to the tip in every pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// By pose.
    pub poses: Vec<PhaseStatistics>,
}

impl Statistics {
    /// Puts both routes together, for a limb of so many modules.
    pub fn new(linear: &[Linear], samples: &[Sample], modules: usize) -> Self {
        let of_pose = |(pose, linear): (usize, &Linear)| {
            let deviations: Vec<&Deviation> = samples.iter().map(|sample| &sample[pose]).collect();
            PhaseStatistics::new(linear, &deviations, modules)
        };
        Self { poses: linear.iter().enumerate().map(of_pose).collect() }
    }
}

impl PhaseStatistics {
    fn new(linear: &Linear, deviations: &[&Deviation], modules: usize) -> Self {
        let mut lost = vec![0; modules];
        let mut answered: Vec<(Vector3<f64>, &Deviation)> = Vec::with_capacity(deviations.len());
        for deviation in deviations {
            match deviation.displacement_m {
                Ok(displacement) => answered.push((displacement, deviation)),
                Err(module) => lost[module] += 1,
            }
        }
        let squares: Vec<f64> = answered.iter().map(|(displacement, _)| displacement.norm_squared()).collect();
        let mean_square = Estimate::of_mean(&squares);
        let rms = mean_square.value.sqrt();
        let departures = answered.iter().map(|(found, deviation)| (found - deviation.linear_m).norm_squared());
        let distances =
            answered.iter().map(|(displacement, deviation)| (deviation.linear_m.norm(), displacement.norm()));
        let (linear_m, found_m): (Vec<f64>, Vec<f64>) = distances.unzip();
        let all = if rms > NOTHING_M { Varied::all(modules) } else { Vec::new() };
        let share = |(index, varied): (usize, Varied)| Share {
            varied,
            linear: linear.mean_square_of_m2(varied) / linear.mean_square_m2(),
            sampled: Estimate::of_ratio(
                answered.iter().zip(&squares).filter_map(|((_, d), all)| Some((d.parts_m2[index]?, *all))),
            ),
        };
        Self {
            answered: answered.len(),
            lost,
            linear_rms_m: linear.mean_square_m2().sqrt(),
            rms_m: Estimate { value: rms, error: if rms > 0.0 { 0.5 * mean_square.error / rms } else { 0.0 } },
            p95_m: [linear_m, found_m].map(|distances| percentile(distances, 95).unwrap_or(0.0)),
            max_m: squares.iter().copied().fold(0.0, f64::max).sqrt(),
            mean_m: mean(answered.iter().map(|(displacement, _)| *displacement)).unwrap_or_default(),
            departure_m: mean(departures).map_or(0.0, f64::sqrt),
            shares: all.into_iter().enumerate().map(share).collect(),
        }
    }

    /// Number of samples without an answer.
    pub fn lost_in_all(&self) -> usize {
        self.lost.iter().sum()
    }

    /// RMS distance of the two routes over the RMS displacement; 0 where the tip does not move.
    pub fn departure(&self) -> f64 {
        if self.rms_m.value > NOTHING_M { self.departure_m / self.rms_m.value } else { 0.0 }
    }

    /// Whether the linear route is enough: the routes differ by less than a tenth of the displacement, and every sample has an answer.
    pub fn linear_is_enough(&self) -> bool {
        self.departure() <= ENOUGH && self.lost_in_all() == 0
    }
}
