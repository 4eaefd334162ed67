//! Arithmetic of kernels: one float, or several side by side.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::number::scalar::Scalar;

/// The arithmetic of kernels: that of a float, or of several actuators side by side.
///
/// Every [`Real`](crate::Real) has it; a vector type of several floats gets the kernels by implementing it.
pub trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Number of derivatives that it carries along.
    const DERIVATIVES: u32 = 0;

    /// A constant of the source; `self` only tells the type.
    fn of(self, value: f64) -> Self;

    /// Whether it has the digits of an `f32`; `self` only tells the type.
    fn is_single(self) -> bool;

    /// Whether it is at most as large as another; of several, whether all are.
    fn is_at_most(self, other: Self) -> bool;

    /// `atanh(s)/s` from `s^2`. Vectors may leave `s^2 > ATANH_REACH` to the caller to discard.
    fn atanh_over(self, s2: Self) -> Self;

    /// The magnitude.
    fn magnitude(self) -> Self;

    /// The square root.
    fn root(self) -> Self;

    /// `self + a b`, rounded once where that is not slower.
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }

    /// `self - a b`, rounded once where that is not slower.
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    /// The smaller one; either where one is not a number.
    fn least(self, other: Self) -> Self;

    /// The larger one.
    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        -(-self).least(-other)
    }

    /// Three inverses and `self/d`.
    #[inline(always)]
    fn over_and_inverses(self, d: Self, [a, b, c]: [Self; 3]) -> (Self, [Self; 3]) {
        let one = self.of(1.0);
        (self / d, [one / a, one / b, one / c])
    }
}

/// `s^2` up to which [`atanh_series`] has the digits of an `f64`.
pub(crate) const ATANH_REACH: f64 = 0.09;
/// `s^2` up to which the shorter series below have their digits.
const SHORT_REACH: f64 = 0.0297;

/// `atanh(s)/s = 1 + s^2/3 + s^4/5 + ...` from `s^2` up to 0.09, to the digits of an `f64`.
///
/// The last coefficient stands for the rest of the series, here and below.
#[inline(always)]
pub fn atanh_series<S: Arithmetic>(s2: S) -> S {
    let s4 = s2 * s2;
    let s8 = s4 * s4;
    let four = |a, b, c, d| pair(s2, a, b).plus_product(s4, pair(s2, c, d));
    let last = four(17.0, 19.0, 21.0, 23.0).plus_product(s8, pair(s2, 25.0, 24.882_62));
    four(1.0, 3.0, 5.0, 7.0).plus_product(s8, four(9.0, 11.0, 13.0, 15.0).plus_product(s8, last))
}

/// The same up to 0.0297.
#[inline(always)]
fn atanh_series_short<S: Arithmetic>(s2: S) -> S {
    let s4 = s2 * s2;
    let s8 = s4 * s4;
    let low = pair(s2, 1.0, 3.0) + s4 * pair(s2, 5.0, 7.0);
    let high = pair(s2, 9.0, 11.0) + s4 * pair(s2, 13.0, 15.0);
    low + s8 * (high + s8 * s2.of(1.0 / 16.578_959))
}

/// The same up to 0.0297, to the digits of an `f32`.
#[inline(always)]
fn atanh_series_single<S: Arithmetic>(s2: S) -> S {
    pair(s2, 1.0, 3.0) + s2 * s2 * pair(s2, 5.0, 6.849_191_1)
}

/// `1/a + s2/b`.
#[inline(always)]
fn pair<S: Arithmetic>(s2: S, a: f64, b: f64) -> S {
    s2.of(1.0 / a).plus_product(s2, s2.of(1.0 / b))
}

impl<T: Scalar> Arithmetic for T {
    const DERIVATIVES: u32 = T::ORDER;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        T::constant(value)
    }

    #[inline(always)]
    fn is_single(self) -> bool {
        T::epsilon() > T::constant(1e-9)
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn atanh_over(self, s2: Self) -> Self {
        if s2 <= T::constant(SHORT_REACH) {
            return if self.is_single() { atanh_series_single(s2) } else { atanh_series_short(s2) };
        }
        atanh_by_logarithm(self)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    /// In single precision by one division, which costs a microcontroller as much as fourteen products.
    #[inline(always)]
    fn over_and_inverses(self, d: Self, [a, b, c]: [Self; 3]) -> (Self, [Self; 3]) {
        let one = T::one();
        if !self.is_single() {
            return (self / d, [one / a, one / b, one / c]);
        }
        let (ab, cd) = (a * b, c * d);
        let inverse = one / (ab * cd);
        let (per_ab, per_cd) = (inverse * cd, inverse * ab);
        (self * (per_cd * c), [per_ab * b, per_ab * a, per_cd * d])
    }
}

#[cold]
fn atanh_by_logarithm<T: Scalar>(s: T) -> T {
    let two = T::constant(2.0);
    (two * s / (T::one() - s)).ln_1p() / (two * s)
}
