//! A function of a pressure as a polynomial, by Chebyshev nodes.

use std::f64::consts::PI;

/// Numbers of nodes that are tried, the least first.
const COUNTS: [usize; 5] = [8, 12, 16, 20, 24];

/// Values of several functions at one place.
type Values<const N: usize> = [f64; N];

/// Polynomials of several functions on 0 to 1, in powers of `2x - 1`, and the largest error found between the nodes, each function's
/// relative to the largest value it has.
pub(super) struct Fit<const N: usize> {
    pub(super) powers: [Vec<f64>; N],
    pub(super) error: f64,
}

/// Fits functions of a share, 0 to 1, to a relative error, or as well as 24 nodes can. `None` where they have no value.
pub(super) fn fit<const N: usize>(f: impl Fn(f64) -> Option<Values<N>>, tolerance: f64) -> Option<Fit<N>> {
    fit_with(&COUNTS, f, tolerance)
}

/// [`fit`] with other numbers of nodes, or as well as the most of them can.
pub(super) fn fit_with<const N: usize>(
    counts: &[usize],
    f: impl Fn(f64) -> Option<Values<N>>,
    tolerance: f64,
) -> Option<Fit<N>> {
    let mut best: Option<Fit<N>> = None;
    for count in counts.iter().copied() {
        let nodes: Vec<f64> = (0..count).map(|k| (PI * (k as f64 + 0.5) / count as f64).cos()).collect();
        let values = nodes.iter().map(|y| f(0.5 + 0.5 * y)).collect::<Option<Vec<_>>>()?;
        let powers: [Vec<f64>; N] = std::array::from_fn(|n| {
            let column: Vec<f64> = values.iter().map(|row| row[n]).collect();
            powers(&chebyshev(&column))
        });
        let error = error(&powers, &f, count)?;
        if best.as_ref().is_none_or(|best| error < best.error) {
            best = Some(Fit { powers, error });
        }
        if error <= tolerance {
            break;
        }
    }
    best
}

/// Coefficients of Chebyshev polynomials from values at their nodes.
fn chebyshev(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let coefficient = |k: usize| {
        let node = |i: usize| (PI * k as f64 * (i as f64 + 0.5) / count as f64).cos();
        let sum: f64 = values.iter().enumerate().map(|(i, value)| value * node(i)).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / count as f64
    };
    (0..count).map(coefficient).collect()
}

/// The same polynomial in powers, by `T_(k+1) = 2 y T_k - T_(k-1)`.
fn powers(coefficients: &[f64]) -> Vec<f64> {
    let count = coefficients.len();
    let mut sum = vec![0.0; count];
    let (mut last, mut this) = (vec![0.0; count], vec![0.0; count]);
    this[0] = 1.0;
    for (k, coefficient) in coefficients.iter().enumerate() {
        sum.iter_mut().zip(&this).for_each(|(sum, term)| *sum += coefficient * term);
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let mut next = vec![0.0; count];
        (1..count).for_each(|i| next[i] = factor * this[i - 1]);
        next.iter_mut().zip(&last).for_each(|(next, last)| *next -= last);
        (last, this) = (this, next);
    }
    sum
}

/// The largest relative error at places between the nodes and at both ends.
fn error<const N: usize>(powers: &[Vec<f64>; N], f: &impl Fn(f64) -> Option<Values<N>>, count: usize) -> Option<f64> {
    let (mut off, mut size) = ([0.0_f64; N], [0.0_f64; N]);
    for index in 0..=2 * count {
        let share = index as f64 / (2 * count) as f64;
        let exact = f(share)?;
        for n in 0..N {
            off[n] = off[n].max((value(&powers[n], share) - exact[n]).abs());
            size[n] = size[n].max(exact[n].abs());
        }
    }
    let relative = off.iter().zip(size).map(|(off, size)| if size > 0.0 { off / size } else { *off });
    Some(relative.fold(0.0, f64::max))
}

/// The polynomial at a share.
pub(super) fn value(powers: &[f64], share: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| sum * (2.0 * share - 1.0) + power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_functions_are_fitted_and_the_error_is_true() {
        let fit = fit(|x| Some([(2.0 * x).exp(), (3.0 * x).sin()]), 1e-10).unwrap();
        assert!(fit.error <= 1e-10, "{:e}", fit.error);
        for x in [0.0_f64, 0.123, 0.77, 1.0] {
            assert!((value(&fit.powers[0], x) - (2.0 * x).exp()).abs() < 1e-9);
            assert!((value(&fit.powers[1], x) - (3.0 * x).sin()).abs() < 1e-9);
        }
    }

    #[test]
    fn kink_is_owned_up_to() {
        let kink = |x: f64| Some([(x - 0.5).abs()]);
        let fit = fit(kink, 1e-10).unwrap();
        let worst = (0..1000).map(|i| f64::from(i) * 1e-3).map(|x| (value(&fit.powers[0], x) - (x - 0.5).abs()).abs());
        let worst = worst.fold(0.0, f64::max);
        assert!(worst > 1e-3 && fit.error > 0.3 * worst && fit.error < 3.0 * worst, "{worst:e} {:e}", fit.error);
    }

    #[test]
    fn absent_values_are_not_fitted() {
        assert!(fit(|x| (x < 0.9).then_some([x]), 1e-10).is_none());
    }
}
