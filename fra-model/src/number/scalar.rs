//! Arithmetic of the model's kernels: floats, dual numbers, double-double numbers.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use nalgebra::Vector3;

use crate::number::real::{Real, real};
use crate::number::sin_cos;

/// The arithmetic of a kernel. Every [`Real`] has it, and so have [`Dual`](crate::number::dual::Dual) and [`DoubleDouble`](crate::number::double_double::DoubleDouble), which are no
/// full scalar fields.
pub(crate) trait Scalar:
    Copy
    + Debug
    + PartialOrd
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// Number of derivatives that it carries along.
    const ORDER: u32 = 0;

    /// A constant of the source.
    fn constant(value: f64) -> Self;
    /// The smallest relative change of the float underneath: how exact an answer can be.
    fn epsilon() -> Self;
    /// The relative rounding of sums, products, quotients and roots.
    fn rounding() -> Self;
    fn is_finite(self) -> bool;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    fn ln_1p(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    fn max(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Zero; derivatives stay what they are.
    fn without_value(self) -> Self {
        Self::zero()
    }

    fn zero() -> Self {
        Self::constant(0.0)
    }

    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl<T: Real> Scalar for T {
    #[inline]
    fn constant(value: f64) -> Self {
        real(value)
    }

    #[inline]
    fn epsilon() -> Self {
        T::default_epsilon()
    }

    #[inline]
    fn rounding() -> Self {
        T::default_epsilon()
    }

    #[inline]
    fn is_finite(self) -> bool {
        nalgebra::ComplexField::is_finite(&self)
    }

    #[inline]
    fn abs(self) -> Self {
        nalgebra::ComplexField::abs(self)
    }

    #[inline]
    fn sqrt(self) -> Self {
        nalgebra::ComplexField::sqrt(self)
    }

    #[inline]
    fn exp(self) -> Self {
        nalgebra::ComplexField::exp(self)
    }

    #[inline]
    fn ln(self) -> Self {
        nalgebra::ComplexField::ln(self)
    }

    #[inline]
    fn ln_1p(self) -> Self {
        nalgebra::ComplexField::ln_1p(self)
    }

    #[inline]
    fn sin(self) -> Self {
        sin_cos(self).0
    }

    #[inline]
    fn cos(self) -> Self {
        sin_cos(self).1
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}

/// The magnitudes of the components.
pub(crate) fn magnitudes<T: Scalar>(v: &Vector3<T>) -> Vector3<T> {
    v.map(T::abs)
}

/// The largest magnitude of a component.
pub(crate) fn largest<T: Scalar>(v: &Vector3<T>) -> T {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

/// The scalar product.
pub(crate) fn dot<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}
