//! Newton's method in twice the digits, and small linear systems.

use super::number::{Number, Pair};
use super::wall::{INPUTS, Rule, Tube};

/// Newton's method from a state next to the answer: in `f64`, then, with `exact`, in pairs for about 25 digits. The matrix is of `f64`.
pub(crate) fn polish(tube: &Tube, rule: &Rule, exact: Option<&Rule>, state: [f64; 3]) -> Option<[Pair; 3]> {
    let inputs: [Pair; INPUTS] = tube.inputs.map(Pair::of);
    // pi = 3.14159265358979311600 + 1.2246467991473532e-16.
    let pi = Pair { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
    let applied = Tube::applied(&inputs, pi);
    let mut at = state.map(Pair::of);
    let (mut last, mut in_pairs) = (f64::MAX, false);
    for _ in 0..40 {
        let (loads, slopes) = tube.linearised(rule, at.map(Number::value));
        let mut matrix = [[0.0; 4]; 4];
        (0..3).for_each(|i| matrix[i][..3].copy_from_slice(&slopes[i]));
        matrix[3][3] = 1.0;
        let mut rest = [loads[0] - applied[0].high, loads[1] - applied[1].high, loads[2] - applied[2].high, 0.0];
        if let Some(rule) = exact.filter(|_| in_pairs) {
            let loads = tube.loads(rule, &inputs, at);
            (0..3).for_each(|i| rest[i] = (loads[i] - applied[i]).value());
        }
        if !tube.twists {
            rest[2] = 0.0;
        }
        let newton = solve(matrix, rest)?;
        (0..3).for_each(|i| at[i] = at[i] - Pair::of(newton[i]));
        let (size, scale) = (largest(&newton), largest(&at.map(Number::value)));
        if !size.is_finite() || scale > 1e6 {
            return None;
        }
        if size <= 1e-12 * scale || (size >= 0.5 * last && size <= 1e-8 * scale) {
            // In pairs every step leaves a billionth of the last one.
            if in_pairs || exact.is_none() {
                return (size <= 1e-8 * scale).then_some(at);
            }
            (in_pairs, last) = (true, f64::MAX);
        } else {
            last = size;
        }
    }
    None
}

/// The largest magnitude.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// Gauss elimination with scaled partial pivoting.
pub(crate) fn solve(mut a: [[f64; 4]; 4], mut b: [f64; 4]) -> Option<[f64; 4]> {
    for i in 0..4 {
        let size = largest(&a[i]);
        a[i] = a[i].map(|v| v / size);
        b[i] /= size;
    }
    for k in 0..4 {
        let pivot = (k..4).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        a.swap(k, pivot);
        b.swap(k, pivot);
        if a[k][k] == 0.0 || !a[k][k].is_finite() {
            return None;
        }
        for i in k + 1..4 {
            let factor = a[i][k] / a[k][k];
            (k..4).for_each(|j| a[i][j] -= factor * a[k][j]);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..4).rev() {
        let known: f64 = (k + 1..4).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    Some(b)
}
