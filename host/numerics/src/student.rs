//! Student's distribution, for confidence intervals.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// More degrees of freedom than this make no difference: the quantile is then within 2e-4 of that of the normal distribution.
const MOST: usize = 10_000;

/// Share of the distribution within `-t..t`, by the finite sums of Abramowitz and Stegun, 26.7.3 and 26.7.4.
fn share_within(t: f64, freedom: usize) -> f64 {
    let angle = (t / (freedom as f64).sqrt()).atan();
    let (sine, cosine) = angle.sin_cos();
    let odd = freedom % 2 == 1;
    let (mut term, mut sum) = (if odd { cosine } else { 1.0 }, 0.0);
    let mut next = if odd { 3 } else { 2 };
    while next <= freedom {
        sum += term;
        term *= cosine * cosine * (next - 1) as f64 / next as f64;
        next += 2;
    }
    if odd { FRAC_2_PI * (angle + sine * sum) } else { sine * sum }
}

/// The `t` within which, both signs, lies the given share of Student's distribution.
///
/// `share` is between 0 and 1, both excluded; infinite for no degree of freedom.
pub fn quantile(share: f64, freedom: usize) -> f64 {
    if freedom == 0 {
        return f64::INFINITY;
    }
    let freedom = freedom.min(MOST);
    // In the angle whose tangent is t over the root of the freedom, which is bounded.
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    let root = (freedom as f64).sqrt();
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if share_within(root * f64::tan(middle), freedom) < share { low = middle } else { high = middle }
    }
    root * f64::tan(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tables that every book of statistics prints.
    #[test]
    fn quantiles_are_those_of_the_printed_tables() {
        for (freedom, printed) in
            [(1, 12.706), (2, 4.303), (3, 3.182), (5, 2.571), (10, 2.228), (30, 2.042), (120, 1.980)]
        {
            assert!((quantile(0.95, freedom) - printed).abs() < 6e-4, "{freedom}: {}", quantile(0.95, freedom));
        }
        assert!((quantile(0.99, 4) - 4.604).abs() < 6e-4);
        assert!((quantile(0.95, usize::MAX) - 1.960).abs() < 6e-4);
        assert_eq!(quantile(0.95, 0), f64::INFINITY);
    }
}
