//! Coefficients of a Chebyshev series.

use std::f64::consts::PI;

/// Nodes of the interpolation; twice the coefficients that a device takes, so that what is cut off is known.
const NODES: usize = 64;

/// The first 32 coefficients of the series of `f` on `0..=1`, from `c_0`, by interpolation at Chebyshev's nodes.
pub(super) fn coefficients(f: impl Fn(f64) -> f64) -> Vec<f64> {
    let angle = |node: usize| PI * (node as f64 + 0.5) / NODES as f64;
    let values: Vec<f64> = (0..NODES).map(|node| f(0.5 + 0.5 * angle(node).cos())).collect();
    let coefficient = |k: usize| {
        let sum: f64 = values.iter().enumerate().map(|(node, value)| value * (k as f64 * angle(node)).cos()).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / NODES as f64
    };
    (0..NODES / 2).map(coefficient).collect()
}

/// What the coefficients behind the first `count` add at most.
pub(super) fn tail(coefficients: &[f64], count: usize) -> f64 {
    coefficients.iter().skip(count).map(|c| c.abs()).sum()
}

/// The first `count` coefficients as the device takes them.
pub(super) fn rounded(coefficients: &[f64], count: usize) -> Vec<f32> {
    coefficients.iter().take(count).map(|&c| c as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomial_has_the_coefficients_of_its_identity() {
        // (2t-1)^3 = (3 T_1 + T_3)/4.
        let found = coefficients(|t| (2.0 * t - 1.0).powi(3));
        for (k, c) in found.iter().enumerate() {
            let wanted = [0.0, 0.75, 0.0, 0.25].get(k).copied().unwrap_or(0.0);
            assert!((c - wanted).abs() < 1e-15, "{k}: {c}");
        }
        assert!((tail(&found, 2) - 0.25).abs() < 1e-13);
        assert_eq!(rounded(&[0.1, 0.2], 1), [0.1_f32]);
    }
}
