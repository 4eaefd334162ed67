//! Places of mesh lines.

/// `count` equal intervals from `from` to `to`, both of which are among the places to the digit; `count` is at least 1.
pub(crate) fn evenly(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    let at = move |n: usize| if n == count { to } else { from + (to - from) * n as f64 / count as f64 };
    (0..=count).map(at)
}
