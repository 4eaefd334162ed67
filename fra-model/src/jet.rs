//! A number with its derivative, for kernels that need an exact slope.

use core::ops::{Add, Div, Mul, Sub};

use crate::real::Real;

/// `value + slope d`, `d^2 = 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet<T> {
    pub(crate) value: T,
    pub(crate) slope: T,
}

impl<T: Real> Jet<T> {
    pub(crate) fn new(value: T, slope: T) -> Self {
        Self { value, slope }
    }

    /// A number that does not depend on the variable.
    pub(crate) fn constant(value: T) -> Self {
        Self::new(value, T::zero())
    }
}

impl<T: Real> Add for Jet<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.slope + other.slope)
    }
}

impl<T: Real> Sub for Jet<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.slope - other.slope)
    }
}

impl<T: Real> Mul for Jet<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.value * other.value, self.slope * other.value + self.value * other.slope)
    }
}

impl<T: Real> Div for Jet<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(value, (self.slope - value * other.slope) / other.value)
    }
}
