//! What the direct kernel computes with: one float, or several side by side.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::{Real, epsilon, real};

/// The arithmetic of the direct kernel: that of a float, or of several actuators side by side.
///
/// Every [`Real`] has it; a vector type of several floats gets the kernel by implementing it.
pub(crate) trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant of the source; `self` only tells the type.
    fn of(self, value: f64) -> Self;

    /// `atanh(s)/s` from `s^2`. Vectors may leave `s^2 > ATANH_REACH` to the caller to discard.
    fn atanh_over(self, s2: Self) -> Self;

    /// The smaller one; not a number if either is not.
    fn least(self, other: Self) -> Self;
}

/// `s^2` up to which the polynomial of [`atanh_series`] has the digits of an `f64`.
pub(crate) const ATANH_REACH: f64 = 0.0297;

/// `atanh(s)/s = 1 + s^2/3 + s^4/5 + ...`, for `s^2` up to [`ATANH_REACH`]. The last coefficient stands for the rest of the series.
#[inline(always)]
pub(crate) fn atanh_series<S: Arithmetic>(s2: S) -> S {
    let k = |value: f64| s2.of(value);
    let s4 = s2 * s2;
    let s8 = s4 * s4;
    let a = k(1.0) + s2 * k(1.0 / 3.0);
    let b = k(1.0 / 5.0) + s2 * k(1.0 / 7.0);
    let c = k(1.0 / 9.0) + s2 * k(1.0 / 11.0);
    let d = k(1.0 / 13.0) + s2 * k(1.0 / 15.0);
    let e = k(1.0 / 17.0) + s2 * k(1.0 / 18.6);
    (a + s4 * b) + s8 * ((c + s4 * d) + s8 * e)
}

/// The same to the digits of an `f32`.
#[inline(always)]
fn atanh_series_short<S: Arithmetic>(s2: S) -> S {
    let k = |value: f64| s2.of(value);
    let s4 = s2 * s2;
    (k(1.0) + s2 * k(1.0 / 3.0)) + s4 * ((k(1.0 / 5.0) + s2 * k(1.0 / 7.0)) + s4 * k(1.0 / 8.9))
}

impl<T: Real> Arithmetic for T {
    #[inline(always)]
    fn of(self, value: f64) -> Self {
        real(value)
    }

    #[inline(always)]
    fn atanh_over(self, s2: Self) -> Self {
        if s2 <= real(ATANH_REACH) {
            let single = epsilon::<T>() > real::<T>(1e-9);
            return if single { atanh_series_short(s2) } else { atanh_series(s2) };
        }
        atanh_by_logarithm(self)
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        // The negation keeps what is not a number.
        if other >= self { self } else { other }
    }
}

#[cold]
fn atanh_by_logarithm<T: Real>(s: T) -> T {
    let two = real::<T>(2.0);
    (two * s / (T::one() - s)).ln_1p() / (two * s)
}
