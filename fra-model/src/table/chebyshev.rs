//! A Chebyshev expansion on `0..=1`.

use super::TABLE_COEFFICIENTS;
use crate::number::real::{Real, real};
use crate::parameters::{InvalidParameter, require};

/// `f(t) = c_0 + c_1 T_1(x) + c_2 T_2(x) + ...` with `x = 2t - 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chebyshev<T> {
    constant: T,
    /// `c_1` onwards; what is beyond `degree` is zero.
    rest: [T; TABLE_COEFFICIENTS - 1],
    degree: usize,
}

impl<T: Real> Chebyshev<T> {
    /// Takes `c_0` onwards; each must be finite and at most `largest` in magnitude, so that no sum of them can overflow.
    pub(crate) fn new(coefficients: &[T], largest: T) -> Result<Self, InvalidParameter<T>> {
        let refused = |value, allowed| InvalidParameter { field: "coefficients", value, allowed };
        let Some((&constant, others)) = coefficients.split_first() else {
            return Err(refused(T::zero(), "at least one"));
        };
        let mut rest = [T::zero(); TABLE_COEFFICIENTS - 1];
        let places = rest.get_mut(..others.len()).ok_or_else(|| refused(T::zero(), "at most 17"))?;
        places.copy_from_slice(others);
        for &value in coefficients {
            let bounded = value.is_finite() && value.abs() <= largest;
            require(bounded, "coefficients", value, "finite, none beyond the range of the table")?;
        }
        Ok(Self { constant, rest, degree: others.len() })
    }

    fn used(&self) -> &[T] {
        self.rest.get(..self.degree).unwrap_or(&self.rest)
    }

    /// `f(t)` by Clenshaw's recurrence.
    #[inline]
    pub(crate) fn at(&self, t: T) -> T {
        let twice_x = real::<T>(4.0) * t - real::<T>(2.0);
        let (mut b, mut older) = (T::zero(), T::zero());
        for &c in self.used().iter().rev() {
            (b, older) = (twice_x * b + (c - older), b);
        }
        twice_x * real::<T>(0.5) * b + (self.constant - older)
    }

    /// `f(t)` and `df/dt`, the latter by the derivative of the recurrence.
    #[inline]
    pub(crate) fn with_slope(&self, t: T) -> (T, T) {
        let two = real::<T>(2.0);
        let twice_x = real::<T>(4.0) * t - two;
        let (mut b, mut older) = (T::zero(), T::zero());
        let (mut slope, mut older_slope) = (T::zero(), T::zero());
        for &c in self.used().iter().rev() {
            (slope, older_slope) = (two * b + twice_x * slope - older_slope, slope);
            (b, older) = (twice_x * b + (c - older), b);
        }
        let x = twice_x * real::<T>(0.5);
        (x * b + (self.constant - older), two * (b + x * slope - older_slope))
    }
}
