//! The arithmetic of reference and comparison methods: single, double, double-double, and a number with its slope.

use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::ComplexField;
use qd::Quad;

/// Terms of the series of sine and cosine: enough for half a turn.
const SERIES: u32 = 24;

/// What they compute with.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn of(value: f64) -> Self;
    fn sqrt(self) -> Self;
    fn sin_cos(self) -> (Self, Self);
    fn ln_1p(self) -> Self;
    fn pi() -> Self;
    /// The nearest double.
    fn nearest(self) -> f64;
    /// Step of a difference quotient: about the root of the precision.
    fn difference() -> f64;
    /// Smallest relative change.
    fn epsilon() -> f64;
}

macro_rules! float {
    ($float:ident, $difference:literal) => {
        impl Number for $float {
            #[inline]
            fn of(value: f64) -> Self {
                value as $float
            }

            #[inline]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }

            fn sin_cos(self) -> (Self, Self) {
                ComplexField::sin_cos(self)
            }

            #[inline]
            fn ln_1p(self) -> Self {
                ComplexField::ln_1p(self)
            }

            fn pi() -> Self {
                std::$float::consts::PI
            }

            fn nearest(self) -> f64 {
                f64::from(self)
            }

            fn difference() -> f64 {
                $difference
            }

            fn epsilon() -> f64 {
                f64::from($float::EPSILON)
            }
        }
    };
}

float!(f32, 3e-4);
float!(f64, 1e-7);

impl Number for Quad {
    fn of(value: f64) -> Self {
        Self::from(value)
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn sin_cos(self) -> (Self, Self) {
        let square = self * self;
        let series = |first: Self, from: f64| {
            let (mut term, mut sum, mut n) = (first, first, from);
            for _ in 0..SERIES {
                term = -(term * square / Self::from((n + 1.0) * (n + 2.0)));
                sum += term;
                n += 2.0;
            }
            sum
        };
        (series(self, 1.0), series(Self::from(1.0), 0.0))
    }

    fn ln_1p(self) -> Self {
        (self + Self::from(1.0)).ln()
    }

    fn pi() -> Self {
        // What double precision leaves of pi is the sine of its own.
        Self(std::f64::consts::PI, 1.224_646_799_147_353_2e-16)
    }

    fn nearest(self) -> f64 {
        self.0 + self.1
    }

    fn difference() -> f64 {
        1e-14
    }

    fn epsilon() -> f64 {
        f64::EPSILON * f64::EPSILON
    }
}

/// `value + slope d` with `d^2 = 0`.
#[derive(Clone, Copy)]
pub(super) struct Dual<N> {
    pub(super) value: N,
    pub(super) slope: N,
}

impl<N: Number> Dual<N> {
    /// A number that does not depend on the variable.
    pub(super) fn constant(value: N) -> Self {
        Self { value, slope: N::of(0.0) }
    }

    pub(super) fn of(value: f64) -> Self {
        Self::constant(N::of(value))
    }
}

impl<N: Number> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<N: Number> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<N: Number> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl<N: Number> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn off(a: Quad, b: Quad) -> f64 {
        ((a - b) / b).nearest().abs()
    }

    #[test]
    fn double_double_keeps_its_digits() {
        let two = Quad::of(2.0);
        assert!(off(Number::sqrt(two) * Number::sqrt(two), two) < 1e-31);
        let third = Quad::of(1.0) / Quad::of(3.0);
        assert!(off(third * Quad::of(3.0), Quad::of(1.0)) < 1e-31);
        // A sum that double precision cannot hold.
        let tiny = Quad::of(1.0) + Quad::of(1e-25);
        assert!(off(tiny - Quad::of(1.0), Quad::of(1e-25)) < 1e-6);
    }

    #[test]
    fn sine_and_cosine_obey_their_identities() {
        assert!(Number::sin_cos(Quad::pi()).0.nearest().abs() < 1e-30);
        for angle in [1e-3, 0.3, 0.615, 1.1, 1.5] {
            let (s, c) = Number::sin_cos(Quad::of(angle));
            let (s2, c2) = Number::sin_cos(Quad::of(2.0 * angle));
            assert!(off(s * s + c * c, Quad::of(1.0)) < 1e-29, "{angle}");
            assert!(off(Quad::of(2.0) * s * c, s2) < 1e-29, "{angle}");
            assert!(((c * c - s * s) - c2).nearest().abs() < 1e-29, "{angle}");
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        let x = Dual { value: 0.7, slope: 1.0 };
        let f = (x * x - Dual::of(1.0)) / (x + Dual::of(3.0));
        let exact = (2.0 * 0.7 * 3.7 - (0.49 - 1.0)) / (3.7 * 3.7);
        assert!((f.slope - exact).abs() < 1e-15);
    }
}
