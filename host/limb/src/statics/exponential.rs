//! The exponential of a screw, the work of dead forces on what lies behind it, and the derivatives of both in closed form.
//!
//! A screw of a turn `p` and a shift `r` carries a point `y` to `R y + J r` with `R = 1 + a p^ + b p^2` and `J = 1 + b p^ + c p^2`, where `p^` is
//! the matrix of the cross product, and `a = sin t/t`, `b = (1 - cos t)/t^2`, `c = (t - sin t)/t^3` are functions of `s = t^2 = p . p`. Forces `f` at
//! points `y` do the work `tr Y + f . r + a p . (y x f) + b (p . Y p - s tr Y + p . (r x f)) + c ((f . p) (p . r) - s f . r)` with `Y = sum y f^T`,
//! whose derivatives by `p` and `r` are those of a product.

use nalgebra::{Matrix3, Vector3};

/// Terms of the series of the last two functions: below `SERIES` they leave nothing.
const TERMS: usize = 10;
/// The largest square of an angle that the series are for.
const SERIES: f64 = 4.0;

/// `a`, `b` and `c` with their first and second derivatives by `s`.
struct Functions {
    values: [f64; 3],
    first: [f64; 3],
    second: [f64; 3],
}

impl Functions {
    /// Each is `1/k! - s` times the one two below, so that the last two give all of them, and none of the derivatives is a small difference.
    fn of(s: f64) -> Self {
        let [f, g] = if s <= SERIES { series(s) } else { direct(s) };
        let (d, e) = (1.0 / 24.0 - s * f, 1.0 / 120.0 - s * g);
        let (b, c) = (0.5 - s * d, 1.0 / 6.0 - s * e);
        let a = 1.0 - s * c;
        let [db, dc] = [d - 0.5 * c, 0.5 * (3.0 * e - d)];
        let [dd, de] = [2.0 * f - 0.5 * e, 0.5 * (5.0 * g - f)];
        let ddc = 0.5 * (3.0 * de - dd);
        Self { values: [a, b, c], first: [0.5 * (c - b), db, dc], second: [0.5 * (dc - db), dd - 0.5 * dc, ddc] }
    }
}

/// `sum (-s)^k/(2k + 6)!` and `sum (-s)^k/(2k + 7)!`.
fn series(s: f64) -> [f64; 2] {
    const FACTORS: [[f64; 2]; TERMS] = factors();
    FACTORS.iter().rev().fold([0.0; 2], |sum, factor| [factor[0] - s * sum[0], factor[1] - s * sum[1]])
}

const fn factors() -> [[f64; 2]; TERMS] {
    let mut factors = [[1.0 / 720.0, 1.0 / 5040.0]; TERMS];
    let mut k = 1;
    while k < TERMS {
        let n = (2 * k + 6) as f64;
        factors[k] = [factors[k - 1][0] / (n * (n - 1.0)), factors[k - 1][1] / (n * (n + 1.0))];
        k += 1;
    }
    factors
}

fn direct(s: f64) -> [f64; 2] {
    let angle = s.sqrt();
    let (sin, cos) = angle.sin_cos();
    let d = (0.5 - (1.0 - cos) / s) / s;
    let e = (1.0 / 6.0 - (1.0 - sin / angle) / s) / s;
    [(1.0 / 24.0 - d) / s, (1.0 / 120.0 - e) / s]
}

/// A rigid motion as the exponential of a screw.
pub(super) struct Exponential {
    turn: Vector3<f64>,
    shift: Vector3<f64>,
    functions: Functions,
    /// `R`.
    pub(super) rotation: Matrix3<f64>,
    /// `J`, which is also how the rotation moves with the turn: by `J dp`, seen from the start.
    pub(super) jacobian: Matrix3<f64>,
    /// `J r`.
    pub(super) way: Vector3<f64>,
}

/// The work of forces behind an exponential by its turn and shift; seen from its start.
pub(super) struct Work {
    /// First derivatives by turn and shift.
    pub(super) first: [Vector3<f64>; 2],
    /// Second derivatives by the turn twice, and by shift (rows) and turn; twice by the shift there is none.
    pub(super) second: [Matrix3<f64>; 2],
    /// Sum of `dx` cross `f` by turn and shift: work that a turn of all before does on what these move.
    pub(super) arms: [Matrix3<f64>; 2],
}

impl Exponential {
    pub(super) fn new(turn: Vector3<f64>, shift: Vector3<f64>) -> Self {
        let s = turn.norm_squared();
        let functions = Functions::of(s);
        let [a, b, c] = functions.values;
        let (rotation, jacobian) = (rodrigues(&turn, s, a, b), rodrigues(&turn, s, b, c));
        let way = jacobian * shift;
        Self { turn, shift, functions, rotation, jacobian, way }
    }

    /// The work of forces whose sum is `force`, and whose first moment about the end is `carried`: `sum R y f^T`, seen from the start.
    #[inline]
    pub(super) fn work(&self, force: &Vector3<f64>, carried: &Matrix3<f64>) -> Work {
        let moment = &self.rotation.tr_mul(carried);
        let (p, r, f) = (&self.turn, &self.shift, force);
        let Functions { values: [a, b, c], first, second } = &self.functions;
        let s = p.norm_squared();
        let both = moment + moment.transpose();
        let trace = moment.trace();
        let (along, across, drive) = (p.dot(f), p.dot(r), f.dot(r));
        // The three factors of a, b and c, and their gradients.
        let torque = couple(moment);
        let of_b = both * p - p * (2.0 * trace) + r.cross(f);
        let of_c = f * across + r * along - p * (2.0 * drive);
        let factors = [p.dot(&torque), 0.5 * p.dot(&(of_b + r.cross(f))), along * across - s * drive];
        let sum = |by: &[f64; 3]| by[0] * factors[0] + by[1] * factors[1] + by[2] * factors[2];
        let weighted = |by: &[f64; 3]| torque * by[0] + of_b * by[1] + of_c * by[2];
        let (change, fp) = (2.0 * sum(first), f.cross(p));
        let sweep = p * along - f * s;
        let by_turn = torque * *a + of_b * *b + of_c * *c + p * change;
        let by_shift = f + fp * *b + sweep * *c;

        let outer = weighted(first) + p * sum(second);
        let mut twice = both * *b + (f * r.transpose() + r * f.transpose()) * *c;
        let mixed = outer * p.transpose() * 2.0;
        twice += mixed + mixed.transpose();
        let diagonal = change - 2.0 * (b * trace + c * drive);
        (0..3).for_each(|i| twice[(i, i)] += diagonal);
        let shift_turn = self.bilinear(f, *b, along, &(fp * first[1] + sweep * first[2]));

        // The way moves with the turn as the gradient by the shift does, but for the sign of the odd term.
        let pr = p.cross(r);
        let way_turn = self.bilinear(r, -b, across, &(pr * first[1] + (p * across - r * s) * first[2]));
        let mut lean = *carried;
        let carried_trace = carried.trace();
        (0..3).for_each(|i| lean[(i, i)] -= carried_trace);
        let arms = [lean * self.jacobian + crossed(&way_turn, f), crossed(&self.jacobian, f)];
        Work { first: [by_turn, by_shift], second: [twice, shift_turn], arms }
    }

    /// Derivative by the turn `p` of `b v x p + c (p (p . v) - s v)`, with the derivatives of `b` and `c` in `slopes`.
    fn bilinear(&self, v: &Vector3<f64>, b: f64, along: f64, slopes: &Vector3<f64>) -> Matrix3<f64> {
        let (p, c) = (&self.turn, self.functions.values[2]);
        let mut matrix = p * v.transpose() * c + (slopes - v * c) * p.transpose() * 2.0;
        let (even, odd) = (c * along, v * b);
        (0..3).for_each(|i| matrix[(i, i)] += even);
        for (row, column, value) in [(2, 1, odd.x), (0, 2, odd.y), (1, 0, odd.z)] {
            matrix[(row, column)] += value;
            matrix[(column, row)] -= value;
        }
        matrix
    }
}

/// `1 + odd p^ + even p^2`.
fn rodrigues(p: &Vector3<f64>, s: f64, odd: f64, even: f64) -> Matrix3<f64> {
    let (o, e) = (p * odd, p * even);
    let one = 1.0 - s * even;
    Matrix3::new(
        one + e.x * p.x,
        e.x * p.y - o.z,
        e.x * p.z + o.y,
        e.x * p.y + o.z,
        one + e.y * p.y,
        e.y * p.z - o.x,
        e.x * p.z - o.y,
        e.y * p.z + o.x,
        one + e.z * p.z,
    )
}

/// The cross products of the columns with a vector.
fn crossed(matrix: &Matrix3<f64>, by: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[0, 1, 2].map(|column: usize| matrix.column(column).cross(by)))
}

/// `sum x cross f` of `sum x f^T`.
fn couple(m: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(m[(1, 2)] - m[(2, 1)], m[(2, 0)] - m[(0, 2)], m[(0, 1)] - m[(1, 0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_those_of_sine_and_cosine() {
        for angle in [0.5_f64, 1.0, 1.9, 1.99999, 2.00001, 2.5, 6.0] {
            let (sin, cos) = angle.sin_cos();
            let s = angle * angle;
            let found = Functions::of(s);
            let exact = [sin / angle, (1.0 - cos) / s, (angle - sin) / (s * angle)];
            for (found, exact) in found.values.iter().zip(exact) {
                assert!((found - exact).abs() < 1e-14, "{angle}: {found} {exact}");
            }
            // Derivatives by s of the closed forms.
            let first = [(cos - sin / angle) / (2.0 * s), (0.5 * sin * angle - (1.0 - cos)) / (s * s)];
            for (found, exact) in found.first.iter().zip(first) {
                assert!((found - exact).abs() < 1e-14, "{angle}: {found} {exact}");
            }
            let step = 1e-4;
            let (low, high) = (Functions::of(s - step), Functions::of(s + step));
            for i in 0..3 {
                let slope =
                    [(high.values[i] - low.values[i]), (high.first[i] - low.first[i])].map(|d| d / (2.0 * step));
                assert!((slope[0] - found.first[i]).abs() < 1e-8, "{angle} {i}");
                assert!((slope[1] - found.second[i]).abs() < 1e-8, "{angle} {i}");
            }
        }
        assert_eq!(Functions::of(0.0).values, [1.0, 0.5, 1.0 / 6.0]);
    }

    #[test]
    fn turn_is_a_rotation_and_a_shift_along_it_stays() {
        let turn = Vector3::new(0.3, -0.7, 1.1);
        let exact = nalgebra::Rotation3::from_scaled_axis(turn).into_inner();
        let motion = Exponential::new(turn, turn * 2.0);
        assert!((motion.rotation - exact).amax() < 1e-15 && (motion.way - turn * 2.0).amax() < 1e-15);
    }
}
