//! What the kernels of the model compute with: a float, a number with its derivative, a number of twice the digits.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::real::{Real, real};

/// The arithmetic of a kernel. Every [`Real`] has it, and so have [`Jet`](crate::jet::Jet) and [`Two`](crate::two::Two), which are no
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
    /// A constant of the source.
    fn constant(value: f64) -> Self;
    /// The smallest relative change of the float underneath.
    fn epsilon() -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    fn ln_1p(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;

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
        nalgebra::ComplexField::sin(self)
    }

    #[inline]
    fn cos(self) -> Self {
        nalgebra::ComplexField::cos(self)
    }
}
