//! Dual numbers: a value with its derivative, for exact slopes of any kernel.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::number::scalar::Scalar;

/// `value + slope d`, where `d` is positive and smaller than any number: `d^2 = 0`, and dual numbers of one value are ordered by their slopes.
///
/// A dual number of dual numbers carries the derivatives with respect to two variables, and the mixed second one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dual<T> {
    pub(crate) value: T,
    pub(crate) slope: T,
}

impl<T: Scalar> Dual<T> {
    pub(crate) fn new(value: T, slope: T) -> Self {
        Self { value, slope }
    }

    /// A number that does not depend on the variable.
    pub(crate) fn fixed(value: T) -> Self {
        Self::new(value, T::zero())
    }

    /// The variable itself.
    pub(crate) fn variable(value: T) -> Self {
        Self::new(value, T::one())
    }

    /// A function with this value and this derivative at the dual number.
    fn through(self, value: T, derivative: T) -> Self {
        Self::new(value, derivative * self.slope)
    }
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.slope + other.slope)
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.slope - other.slope)
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.slope)
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.value * other.value, self.slope * other.value + self.value * other.slope)
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(value, (self.slope - value * other.slope) / other.value)
    }
}

impl<T: Scalar> AddAssign for Dual<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Dual<T> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Scalar> MulAssign for Dual<T> {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Scalar> DivAssign for Dual<T> {
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<T: Scalar> PartialOrd for Dual<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.value.partial_cmp(&other.value)? {
            Ordering::Equal => self.slope.partial_cmp(&other.slope),
            decided => Some(decided),
        }
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    const ORDER: u32 = T::ORDER + 1;

    fn constant(value: f64) -> Self {
        Self::fixed(T::constant(value))
    }

    fn epsilon() -> Self {
        Self::fixed(T::epsilon())
    }

    fn rounding() -> Self {
        Self::fixed(T::rounding())
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.slope.is_finite()
    }

    fn without_value(self) -> Self {
        Self::new(self.value.without_value(), self.slope)
    }

    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through(root, T::one() / (root + root))
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.through(value, value)
    }

    fn ln(self) -> Self {
        self.through(self.value.ln(), T::one() / self.value)
    }

    fn ln_1p(self) -> Self {
        self.through(self.value.ln_1p(), T::one() / (T::one() + self.value))
    }

    fn sin(self) -> Self {
        self.through(self.value.sin(), self.value.cos())
    }

    fn cos(self) -> Self {
        self.through(self.value.cos(), -self.value.sin())
    }
}
