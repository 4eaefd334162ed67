//! Means, percentiles and Student's distribution.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use std::ops::{Add, Div};

/// Degrees of freedom beyond which the quantile is within 2e-4 of that of the normal distribution.
const MOST: usize = 10_000;

/// Mean of numbers or vectors; `None` of none.
pub fn mean<T: Add<Output = T> + Div<f64, Output = T>>(values: impl IntoIterator<Item = T>) -> Option<T> {
    let mut values = values.into_iter();
    let first = values.next()?;
    let (sum, count) = values.fold((first, 1.0), |(sum, count), value| (sum + value, count + 1.0));
    Some(sum / count)
}

/// Root of the mean square; `None` of no values.
pub fn root_mean_square(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    mean(values.into_iter().map(|value| value * value)).map(f64::sqrt)
}

/// A figure of a sample and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The figure.
    pub value: f64,
    /// Standard error.
    pub error: f64,
}

impl Estimate {
    /// The mean; zero of no values.
    pub fn of_mean(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let value = mean(values.iter().copied()).unwrap_or(0.0);
        let scatter = values.iter().map(|one| (one - value) * (one - value)).sum::<f64>();
        Self { value, error: (scatter / (count - 1.0).max(1.0) / count.max(1.0)).sqrt() }
    }

    /// The ratio of the means of pairs (part, whole) that go together.
    pub fn of_ratio(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (parts, wholes): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let whole = Self::of_mean(&wholes).value;
        let value = Self::of_mean(&parts).value / whole;
        let rest: Vec<f64> = parts.iter().zip(&wholes).map(|(part, whole)| part - value * whole).collect();
        Self { value, error: Self::of_mean(&rest).error / whole }
    }
}

/// The least value that so many percent, 0 to 100, do not exceed; `None` of no values.
pub fn percentile<T: Copy + PartialOrd>(values: impl IntoIterator<Item = T>, percent: usize) -> Option<T> {
    let mut values: Vec<T> = values.into_iter().collect();
    values.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let rank = (values.len() * percent).div_ceil(100).max(1) - 1;
    values.get(rank).copied()
}

/// Fraction of the distribution within `-t..t`, by the finite sums of Abramowitz and Stegun, 26.7.3 and 26.7.4.
fn fraction_within(t: f64, freedom: usize) -> f64 {
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

/// The value that a chi-square variable does not exceed with the given probability.
///
/// `fraction` is between 0 and 1, both excluded; `freedom` from 1 to 500.
pub fn chi_square_quantile(fraction: f64, freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, freedom as f64);
    while chi_square(high, freedom) < fraction && high < 1e4 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if chi_square(middle, freedom) < fraction { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Probability that a chi-square variable does not exceed a value: the series of the incomplete gamma function.
fn chi_square(value: f64, freedom: usize) -> f64 {
    let (a, x) = (0.5 * freedom as f64, 0.5 * value);
    if x <= 0.0 {
        return 0.0;
    }
    // Gamma(a + 1) from Gamma(1) = 1 or Gamma(3/2) = sqrt(pi)/2, step by step.
    let (start, at_start) =
        if freedom.is_multiple_of(2) { (0.0, 1.0) } else { (0.5, 0.5 * std::f64::consts::PI.sqrt()) };
    let log_gamma = f64::ln(at_start) + (1..=freedom / 2).map(|step| (start + step as f64).ln()).sum::<f64>();
    let mut term = (a * x.ln() - x - log_gamma).exp();
    let mut sum = term;
    let mut n = a;
    while term > f64::EPSILON * sum {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    sum.min(1.0)
}

/// The `t` of Student's distribution with the given fraction between `-t` and `t`.
///
/// `fraction` is between 0 and 1, both excluded; infinite for no degree of freedom.
pub fn student_quantile(fraction: f64, freedom: usize) -> f64 {
    if freedom == 0 {
        return f64::INFINITY;
    }
    let freedom = freedom.min(MOST);
    // In the angle whose tangent is t over the root of the freedom, which is bounded.
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    let root = (freedom as f64).sqrt();
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if fraction_within(root * f64::tan(middle), freedom) < fraction { low = middle } else { high = middle }
    }
    root * f64::tan(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tables that every book of statistics prints.
    #[test]
    fn student_quantiles_are_those_of_the_printed_tables() {
        for (freedom, printed) in
            [(1, 12.706), (2, 4.303), (3, 3.182), (5, 2.571), (10, 2.228), (30, 2.042), (120, 1.980)]
        {
            assert!(
                (student_quantile(0.95, freedom) - printed).abs() < 6e-4,
                "{freedom}: {}",
                student_quantile(0.95, freedom)
            );
        }
        assert!((student_quantile(0.99, 4) - 4.604).abs() < 6e-4);
        assert!((student_quantile(0.95, usize::MAX) - 1.960).abs() < 6e-4);
        assert_eq!(student_quantile(0.95, 0), f64::INFINITY);
    }

    #[test]
    fn chi_square_quantiles_are_those_of_the_printed_tables() {
        for (freedom, low, high) in
            [(1, 0.000_98, 5.024), (2, 0.0506, 7.378), (5, 0.831, 12.833), (10, 3.247, 20.483), (100, 74.222, 129.561)]
        {
            let found = [0.025, 0.975].map(|fraction| chi_square_quantile(fraction, freedom));
            assert!((found[0] - low).abs() < 6e-4 && (found[1] - high).abs() < 6e-4, "{freedom}: {found:?}");
        }
    }

    #[test]
    fn percentiles_of_a_hundred_numbers_are_their_ranks() {
        let values = || (1..=100).rev().map(f64::from);
        assert_eq!((percentile(values(), 95), percentile(values(), 100)), (Some(95.0), Some(100.0)));
        assert_eq!((percentile([3.0], 95), percentile(Vec::<f64>::new(), 95)), (Some(3.0), None));
        // Of an even number the lower of the two in the middle.
        assert_eq!((percentile([7, 1, 5, 3], 50), percentile([5, 1, 3], 50)), (Some(3), Some(3)));
    }

    #[test]
    fn means_and_ratios_of_a_few_numbers() {
        assert_eq!((mean([1.0, 2.0, 6.0]), mean(Vec::<f64>::new())), (Some(3.0), None));
        assert_eq!((root_mean_square([3.0, -4.0, 0.0, -5.0]), root_mean_square([])), (Some(12.5_f64.sqrt()), None));
        // 1, 2, 3, 6: mean 3, variance (4 + 1 + 0 + 9)/3, of the mean a quarter of it.
        let found = Estimate::of_mean(&[1.0, 2.0, 3.0, 6.0]);
        assert!((found.value - 3.0).abs() < 1e-15 && (found.error - (14.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        // A part that is always a third of the whole has no error at all.
        let found = Estimate::of_ratio([(1.0, 3.0), (2.0, 6.0), (5.0, 15.0)]);
        assert!((found.value - 1.0 / 3.0).abs() < 1e-15 && found.error < 1e-15);
    }
}
