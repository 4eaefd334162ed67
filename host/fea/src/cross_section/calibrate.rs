//! The bend of one actuator as a polynomial that a microcontroller carries in place of the section model.

use super::Section;
use super::answer::Outcome;
use super::error::SectionError;
use super::options::EndLoad;
use softlimb_files::range::{positive, require};

/// Lowest pressure of a polynomial that serves up to a highest one, as a share of that.
pub const CALIBRATED_FROM: f64 = 0.05;

/// Pressures the polynomial is fitted to.
const FITTED: usize = 8;
/// Pressures it is verified at: both ends, and others than the fitted ones between them.
const VERIFIED: usize = 16;
/// Rounds in which large errors are given more weight, so that the largest becomes small.
const ROUNDS: usize = 40;

/// Pressure by bend rate, `P = a k + b k^2 + c k^3`, with `k` in rad per meter of undeformed length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendPolynomial {
    /// `a`, Pa m; `b`, Pa m2; `c`, Pa m3.
    pub coefficients: [f64; 3],
    /// Bend rates it is meant for: 0 to this, rad/m. It rises all the way.
    pub bend_rate_max_rad_per_m: f64,
}

impl BendPolynomial {
    /// Gauge pressure for a bend rate, Pa.
    pub fn pressure_pa(&self, bend_rate_rad_per_m: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        bend_rate_rad_per_m * (a + bend_rate_rad_per_m * (b + bend_rate_rad_per_m * c))
    }

    /// Bend rate at a gauge pressure, rad/m; held between 0 and the largest one.
    pub fn bend_rate_rad_per_m(&self, pressure_pa: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.bend_rate_max_rad_per_m);
        // The polynomial rises, and a double has 53 bits to halve.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.pressure_pa(middle) < pressure_pa { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Whether the pressure rises with the bend rate from rest to the largest one.
    fn rises(&self) -> bool {
        let [a, b, c] = self.coefficients;
        let slope = |k: f64| a + k * (2.0 * b + 3.0 * c * k);
        let turn = if c == 0.0 { 0.0 } else { (-b / (3.0 * c)).clamp(0.0, self.bend_rate_max_rad_per_m) };
        [0.0, turn, self.bend_rate_max_rad_per_m].into_iter().all(|k| slope(k) > 0.0)
    }
}

/// A polynomial with what it has been held to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// The polynomial.
    pub polynomial: BendPolynomial,
    /// The pressures it was fitted to and verified at, Pa: lowest and highest.
    pub pressures_pa: [f64; 2],
    /// Largest error of its bend rate at sixteen solves, of which only the two ends were fitted, relative to the bend rate there.
    pub verified_error: f64,
    /// The pressure of that error, Pa.
    pub worst_pressure_pa: f64,
    /// Largest estimated error of discretisation of all solves, relative to the bend rate.
    pub mesh_error: f64,
}

/// A pressure and its bend rate.
struct Sample {
    pressure_pa: f64,
    bend_rate: f64,
    mesh_error: f64,
}

impl Section {
    /// Fits the polynomial to the bend towards the strain-limiting layer between two gauge pressures, Pa, without load, so that its largest
    /// relative error is small, and verifies it by solves at other pressures.
    ///
    /// # Errors
    /// [`SectionError::Option`] for pressures out of range, [`SectionError::NoBend`] where the actuator does not bend or where there is no
    /// equilibrium.
    pub fn calibrate(&self, pressures_pa: [f64; 2]) -> Result<Calibration, SectionError> {
        let [low, high] = pressures_pa;
        positive("pressures_pa[0]", low)?;
        require(high.is_finite() && high >= 1.5 * low, "pressures_pa[1]", high, "at least 1.5 times pressures_pa[0]")?;
        let fitted = self.samples(&nodes(low, high, FITTED))?;
        // A finer set of other nodes, with both ends.
        let others = self.samples(&nodes(low, high, VERIFIED))?;
        let largest = fitted.iter().chain(&others).map(|sample| sample.bend_rate).fold(0.0, f64::max);
        let polynomial = BendPolynomial { coefficients: fit(&fitted), bend_rate_max_rad_per_m: 1.02 * largest };
        if !polynomial.rises() {
            return Err(SectionError::NoBend { reason: "the fitted pressure does not rise", pressure_pa: high });
        }
        let error =
            |sample: &Sample| (polynomial.bend_rate_rad_per_m(sample.pressure_pa) / sample.bend_rate - 1.0).abs();
        let errors = others.iter().map(|sample| (error(sample), sample.pressure_pa));
        let (verified_error, worst_pressure_pa) = errors.fold((0.0, low), |a, b| if b.0 > a.0 { b } else { a });
        let mesh_error = fitted.iter().chain(&others).map(|sample| sample.mesh_error).fold(0.0, f64::max);
        Ok(Calibration { polynomial, pressures_pa, verified_error, worst_pressure_pa, mesh_error })
    }

    fn samples(&self, pressures_pa: &[f64]) -> Result<Vec<Sample>, SectionError> {
        let curve = self.curve(pressures_pa, &EndLoad::default())?;
        let sample = |answer: super::Answer| {
            let pressure_pa = answer.pressure_pa;
            let Outcome::Equilibrium(equilibrium) = answer.outcome else {
                return Err(SectionError::NoBend { reason: "there is no equilibrium", pressure_pa });
            };
            let bend_rate = equilibrium.state.bend_rates_rad_per_m[0];
            if bend_rate <= 1e-9 / self.build.radius_m {
                return Err(SectionError::NoBend { reason: "the actuator does not bend", pressure_pa });
            }
            let error = equilibrium.error.map_or(f64::INFINITY, |error| error.bend_rates_rad_per_m[0]);
            Ok(Sample { pressure_pa, bend_rate, mesh_error: error / bend_rate })
        };
        curve.answers.into_iter().map(sample).collect()
    }
}

/// Points from `low` to `high`, both included, that crowd towards the ends as a polynomial's extremes do.
fn nodes(low: f64, high: f64, count: usize) -> Vec<f64> {
    let share = |i: usize| 0.5 - 0.5 * (std::f64::consts::PI * i as f64 / (count - 1) as f64).cos();
    (0..count).map(|i| (low + (high - low) * share(i)).clamp(low, high)).collect()
}

/// The coefficients of least relative error of the pressure. Lawson's rounds of least squares, each weighted by the errors of those
/// before, lead to the fit of the least largest error.
fn fit(samples: &[Sample]) -> [f64; 3] {
    let mut weights = vec![1.0; samples.len()];
    let mut best = (f64::INFINITY, [0.0; 3]);
    for _ in 0..ROUNDS {
        let scaled = least_squares(samples, &weights);
        let errors: Vec<f64> = samples.iter().map(|sample| residual(sample, &scaled).abs()).collect();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        if largest < best.0 {
            best = (largest, scaled);
        }
        weights.iter_mut().zip(&errors).for_each(|(weight, error)| *weight *= error);
        let sum: f64 = weights.iter().sum();
        if sum.is_nan() || sum <= 0.0 {
            break;
        }
        weights.iter_mut().for_each(|weight| *weight /= sum);
    }
    best.1
}

/// Relative error of the pressure.
fn residual(sample: &Sample, coefficients: &[f64; 3]) -> f64 {
    let k = sample.bend_rate;
    k * (coefficients[0] + k * (coefficients[1] + k * coefficients[2])) / sample.pressure_pa - 1.0
}

/// Weighted linear least squares for three coefficients: one solve of the normal equations, without a start or bounds.
fn least_squares(samples: &[Sample], weights: &[f64]) -> [f64; 3] {
    // In units of the largest bend, so that the powers are alike.
    let unit = samples.iter().map(|sample| sample.bend_rate).fold(0.0, f64::max);
    let mut normal = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for (sample, weight) in samples.iter().zip(weights) {
        let k = sample.bend_rate / unit;
        let row = nalgebra::Vector3::new(k, k * k, k * k * k) / sample.pressure_pa;
        normal += row * row.transpose() * *weight;
        right += row * *weight;
    }
    let solved = normal.lu().solve(&right).unwrap_or_else(nalgebra::Vector3::zeros);
    [solved.x / unit, solved.y / unit.powi(2), solved.z / unit.powi(3)]
}
