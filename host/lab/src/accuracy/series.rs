//! The inverse of one actuator as a Chebyshev series: what tables of each degree can do.

use fra_model::{Actuator, Argument, InverseTable, Load, Status, TableParameters};

use super::method::Ready;
use super::number::Number;
use super::question::{Question, Scalar, reached, target};

/// Terms that are computed; a series of a degree is the beginning of them.
const TERMS: usize = 33;
/// A tail of more than this share of the highest pressure is slow.
const SLOW: f64 = 1e-6;
/// The series ends at this share of the pressure asked about.
const BEYOND: f64 = 1.05;

/// `P = sum c_n T_n(2 t - 1)`, `t` the share of the way from the target at rest to the last one, or its root.
#[derive(Clone, Copy, Debug)]
pub(super) struct Series {
    from: f64,
    to: f64,
    root: bool,
    highest_pa: f64,
    coefficients: [f64; TERMS],
}

impl Series {
    /// In the share, or in its root where the share converges slowly and the root faster, as next to a neutral angle. `None` where the
    /// actuator does not reach the end.
    pub(super) fn new(actuator: &Actuator<f64>, pressure_pa: f64) -> Option<Self> {
        let motion = actuator.parameters().motion;
        let highest_pa = BEYOND * pressure_pa;
        let end = actuator.forward(highest_pa, &Load::none()).ok().filter(|end| end.status == Status::Solved)?;
        let (from, to) = (reached(motion, &actuator.rest()), reached(motion, &end.state));
        let series = |root| {
            let mut pressures = [0.0; TERMS];
            for (index, pressure) in pressures.iter_mut().enumerate() {
                let x = ((index as f64 + 0.5) * std::f64::consts::PI / TERMS as f64).cos();
                let t = 0.5 * (1.0 + x);
                let wanted = target(motion, from + (to - from) * if root { t * t } else { t });
                let found = actuator.inverse(wanted, &Load::none()).ok().filter(|found| found.status == Status::Solved);
                *pressure = found.map_or(f64::NAN, |found| found.state.pressure_pa);
            }
            Self { from, to, root, highest_pa, coefficients: transform(&pressures) }
        };
        let share = series(false);
        if share.tail() < SLOW * highest_pa {
            return Some(share);
        }
        let root = series(true);
        Some(if root.tail() < share.tail() { root } else { share })
    }

    /// How slowly it converges; infinite where a pressure is missing.
    fn tail(&self) -> f64 {
        let sum: f64 = self.coefficients.iter().skip(TERMS / 3).map(|c| c.abs()).sum();
        if sum.is_finite() { sum } else { f64::INFINITY }
    }
}

/// Coefficients from the values at the roots of `T_N`.
fn transform(values: &[f64; TERMS]) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    for (n, coefficient) in coefficients.iter_mut().enumerate() {
        let angle = |index: usize| n as f64 * (index as f64 + 0.5) * std::f64::consts::PI / TERMS as f64;
        let sum: f64 = values.iter().enumerate().map(|(index, value)| value * angle(index).cos()).sum();
        *coefficient = sum * if n == 0 { 1.0 } else { 2.0 } / TERMS as f64;
    }
    coefficients
}

/// The series cut off at a degree, evaluated by Clenshaw's recurrence at the target of a question.
pub(super) fn ready<T: Scalar>(question: &Question, degree: usize) -> Ready<T> {
    let Series { from, to, root, coefficients, .. } = question.series;
    let coefficients: Vec<T> = coefficients.iter().take(degree + 1).rev().map(|&c| T::of(c)).collect();
    let (from, scale, target) = (T::of(from), T::of(1.0 / (to - from)), T::of(question.truth.target));
    let (half, two, four) = (T::of(0.5), T::of(2.0), T::of(4.0));
    Box::new(move || {
        let share = (target - from) * scale;
        let t = if root { Number::sqrt(share) } else { share };
        let twice_x = four * t - two;
        let (mut b, mut older) = (T::of(0.0), T::of(0.0));
        for &c in &coefficients {
            (b, older) = (twice_x * b + (c - older), b);
        }
        // The last round has counted `2x b` where `x b` belongs.
        Some(([b - twice_x * half * older, T::of(0.0), T::of(0.0)], 0))
    })
}

/// The series cut off at a degree as the device's table, on its finest grid. `None` where the table refuses it.
pub(super) fn table<T: Scalar>(question: &Question, degree: usize) -> Option<Ready<T>> {
    const STEPS: u16 = 32_768;
    let Series { from, to, root, highest_pa, coefficients } = question.series;
    let coefficients: Vec<T> = coefficients.iter().take(degree + 1).map(|&c| T::of(c)).collect();
    let table = InverseTable::new(&TableParameters {
        from: T::of(from),
        to: T::of(to),
        argument: if root { Argument::Root } else { Argument::Linear },
        steps: STEPS,
        pressure_max_pa: T::of(highest_pa),
        coefficients: &coefficients,
    });
    let (table, target) = (table.ok()?, T::of(question.truth.target));
    Some(Box::new(move || Some(([table.lookup(target).ok()?.pressure_pa, T::of(0.0), T::of(0.0)], 0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomial_is_its_own_series() {
        // T_0 + 2 T_1 + 3 T_3.
        let value = |x: f64| 1.0 + 2.0 * x + 3.0 * (4.0 * x.powi(3) - 3.0 * x);
        let mut values = [0.0; TERMS];
        for (index, place) in values.iter_mut().enumerate() {
            *place = value(((index as f64 + 0.5) * std::f64::consts::PI / TERMS as f64).cos());
        }
        let found = transform(&values);
        for (n, c) in found.into_iter().enumerate() {
            let expected = [1.0, 2.0, 0.0, 3.0].get(n).copied().unwrap_or(0.0);
            assert!((c - expected).abs() < 1e-13, "{n}: {c}");
        }
    }
}
