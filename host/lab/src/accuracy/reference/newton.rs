//! Newton's method with difference quotients, for up to three equations.

use crate::accuracy::number::Number;

/// A root and how well it is known.
pub(super) struct Root<N> {
    pub(super) at: [N; 3],
    /// Largest residual there.
    pub(super) residual: f64,
    /// Last step, over the largest coordinate.
    pub(super) step: f64,
}

/// Iterates until the steps no longer shrink. Coordinates beyond the first `unknowns` stay; `None` where it does not converge.
pub(super) fn root<N: Number>(
    start: [N; 3],
    unknowns: usize,
    rounds: u32,
    residuals: impl Fn([N; 3]) -> [N; 3],
) -> Option<Root<N>> {
    let mut at = start;
    let mut last = f64::INFINITY;
    for _ in 0..rounds {
        let here = residuals(at);
        let step = solve(jacobian(at, here, unknowns, &residuals), here, unknowns)?;
        for (coordinate, change) in at.iter_mut().zip(step).take(unknowns) {
            *coordinate = *coordinate - change;
        }
        let scale = largest(at).max(1e-30);
        let relative = largest(step) / scale;
        // The lumen and the length stay positive.
        if !relative.is_finite() || at[0].nearest() <= -1.0 || at[1].nearest() <= -1.0 {
            return None;
        }
        if relative == 0.0 || (relative >= 0.5 * last && relative < 1e-3 * N::difference()) {
            return Some(Root { at, residual: largest(residuals(at)), step: relative });
        }
        last = relative;
    }
    None
}

fn largest<N: Number>(values: [N; 3]) -> f64 {
    values.into_iter().map(|value| value.nearest().abs()).fold(0.0, f64::max)
}

/// Columns of derivatives.
fn jacobian<N: Number>(
    at: [N; 3],
    here: [N; 3],
    unknowns: usize,
    residuals: &impl Fn([N; 3]) -> [N; 3],
) -> [[N; 3]; 3] {
    let mut columns = [[N::of(0.0); 3]; 3];
    let h = N::of(N::difference());
    for (axis, column) in columns.iter_mut().enumerate().take(unknowns) {
        let mut beside = at;
        beside[axis] = beside[axis] + h;
        let there = residuals(beside);
        for row in 0..3 {
            column[row] = (there[row] - here[row]) / h;
        }
    }
    columns
}

/// Gaussian elimination with row pivoting.
fn solve<N: Number>(columns: [[N; 3]; 3], right: [N; 3], unknowns: usize) -> Option<[N; 3]> {
    let mut rows: Vec<[N; 4]> =
        (0..unknowns).map(|row| [columns[0][row], columns[1][row], columns[2][row], right[row]]).collect();
    for axis in 0..unknowns {
        let size = |row: &[N; 4]| row[axis].nearest().abs();
        let pivot = (axis..unknowns).max_by(|&a, &b| size(&rows[a]).total_cmp(&size(&rows[b])))?;
        rows.swap(axis, pivot);
        if size(&rows[axis]) == 0.0 {
            return None;
        }
        let pivot = rows[axis];
        for row in rows.iter_mut().skip(axis + 1) {
            let factor = row[axis] / pivot[axis];
            for (cell, above) in row.iter_mut().zip(pivot) {
                *cell = *cell - factor * above;
            }
        }
    }
    let mut found = [N::of(0.0); 3];
    for axis in (0..unknowns).rev() {
        let known = (axis + 1..unknowns).fold(rows[axis][3], |rest, other| rest - rows[axis][other] * found[other]);
        found[axis] = known / rows[axis][axis];
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use qd::Quad;

    #[test]
    fn roots_are_found_to_the_digits_of_the_number() {
        // x^2 + y = 3, x - y^2 = 0 has the root y = z, x = z^2 with z^4 + z = 3.
        let equations = |[x, y, _]: [Quad; 3]| [x * x + y - Quad::of(3.0), x - y * y, Quad::of(0.0)];
        let root = root([1.0, 1.0, 0.0].map(Quad::of), 2, 30, equations).expect("converges");
        let z = root.at[1];
        assert!((z * z * z * z + z - Quad::of(3.0)).nearest().abs() < 1e-29);
        assert!(root.residual < 1e-29 && root.step < 1e-28, "{} {}", root.residual, root.step);
    }

    #[test]
    fn singular_system_is_no_root() {
        assert!(root([0.1, 0.1, 0.0], 2, 30, |[x, y, _]: [f64; 3]| [x + y - 1.0, x + y - 2.0, 0.0]).is_none());
    }
}
