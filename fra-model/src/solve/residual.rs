//! Residual of a query: the scalar whose root along the branch of equilibria is the solution.

use nalgebra::Vector3;

use crate::number::scalar::{Scalar, dot, magnitudes};
use crate::solve::continuation::Point;

/// A scalar along the branch; the solution is its root.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Residual<T> {
    /// Forward problem: `u_w` equals this `P/mu1`.
    Pressure(T),
    /// Inverse problem: a linear function of `(e, w, g)` reaches a value. Every target of a straight tube has this form.
    Deformation {
        weights: Vector3<T>,
        value: T,
        /// Change of `value` by the last digit of the target.
        last_digit: T,
    },
}

impl<T: Scalar> Residual<T> {
    /// The scalar at a state and its derivative with respect to `w` along the branch.
    pub(crate) fn measure(&self, point: &Point<T>) -> (T, T) {
        match self {
            Self::Pressure(pressure) => (point.pressure - *pressure, point.slope),
            Self::Deformation { weights, value, .. } => {
                (dot(weights, &point.at) - *value, dot(weights, &point.tangent))
            }
        }
    }

    /// Largest magnitude of the scalar that rounding alone explains.
    pub(crate) fn noise(&self, point: &Point<T>) -> T {
        match self {
            Self::Pressure(_) => point.pressure_noise,
            Self::Deformation { weights, last_digit, .. } => {
                let rounding = magnitudes(&point.at) * (T::constant(8.0) * T::rounding());
                dot(&magnitudes(weights), &(rounding + point.settling_noise)) + *last_digit
            }
        }
    }

    /// Whether the root lies towards larger volume, to first order.
    pub(crate) fn lies_outwards(&self, from: &Point<T>) -> bool {
        let (value, rate) = self.measure(from);
        -value / rate > T::zero()
    }

    /// The same residual in another scalar.
    pub(crate) fn map<U: Scalar>(&self, f: impl Fn(T) -> U) -> Residual<U> {
        match self {
            Self::Pressure(pressure) => Residual::Pressure(f(*pressure)),
            Self::Deformation { weights, value, last_digit } => {
                Residual::Deformation { weights: weights.map(&f), value: f(*value), last_digit: f(*last_digit) }
            }
        }
    }
}
