//! Several specimens of one actuator: the mean of their values, and how much specimens differ.
//!
//! Random effects: the value of a specimen is `m + b`, `b` normal with the deviation `t` between specimens, and its estimate has the deviation `s` of its own
//! fit besides.

use softlimb_numerics::statistics::{chi_square_quantile, student_quantile};

/// Fewest specimens of which a spread is stated.
pub const SPECIMENS_MIN: usize = 3;
/// Halvings of the interval in which a spread is sought.
const HALVINGS: usize = 200;

/// Mean and spread of a value over specimens, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomEffects {
    /// The mean over all specimens that may be made.
    pub mean: f64,
    /// Ends of its confidence interval (Hartung and Knapp).
    pub interval: [f64; 2],
    /// Standard deviation between specimens (Paule and Mandel).
    pub spread: f64,
    /// Ends of its confidence interval (Q profile).
    pub spread_interval: [f64; 2],
}

/// Mean and spread of estimates with their standard deviations, one of each specimen; `None` of fewer than [`SPECIMENS_MIN`], or of a deviation that is
/// negative or not finite.
pub fn random_effects(estimates: &[(f64, f64)], confidence: f64) -> Option<RandomEffects> {
    let is_valid = |(value, deviation): &(f64, f64)| value.is_finite() && deviation.is_finite() && *deviation >= 0.0;
    if estimates.len() < SPECIMENS_MIN || !estimates.iter().all(is_valid) {
        return None;
    }
    let freedom = estimates.len() - 1;
    let plain = estimates.iter().map(|(value, _)| value).sum::<f64>() / estimates.len() as f64;
    let largest = estimates.iter().map(|(value, _)| (value - plain).abs()).fold(0.0, f64::max);
    // Specimens without any difference, nor an error of their own, have no spread.
    if largest == 0.0 {
        return Some(RandomEffects { mean: plain, interval: [plain; 2], spread: 0.0, spread_interval: [0.0; 2] });
    }
    // The weighted sum of squares falls with the spread, and has the chi-square distribution at the true one.
    let weighted = |variance: f64| {
        let floor = (f64::EPSILON * largest).powi(2);
        let weights: Vec<f64> = estimates.iter().map(|(_, s)| 1.0 / (s * s + variance).max(floor)).collect();
        let total: f64 = weights.iter().sum();
        let mean = estimates.iter().zip(&weights).map(|((value, _), weight)| weight * value).sum::<f64>() / total;
        let squares = estimates.iter().zip(&weights).map(|((value, _), weight)| weight * (value - mean).powi(2));
        (mean, total, squares.sum::<f64>())
    };
    let spread_of = |squares: f64| {
        if weighted(0.0).2 <= squares {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, largest);
        while weighted(high * high).2 > squares {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if weighted(middle * middle).2 > squares { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let spread = spread_of(freedom as f64);
    let (mean, total, squares) = weighted(spread * spread);
    let half_width = student_quantile(confidence, freedom) * (squares / (freedom as f64 * total)).sqrt();
    let tail = 0.5 * (1.0 - confidence);
    Some(RandomEffects {
        mean,
        interval: [mean - half_width, mean + half_width],
        spread,
        spread_interval: [1.0 - tail, tail].map(|fraction| spread_of(chi_square_quantile(fraction, freedom))),
    })
}
