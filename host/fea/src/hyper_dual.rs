//! Numbers that carry exact first and second derivatives through any polynomial: what tests hold hand-written derivatives to.

use std::iter::Sum;
use std::ops::{Add, Mul, Neg, Sub};

/// `value + first[0] e1 + first[1] e2 + second e1 e2` with `e1^2 = e2^2 = 0`: a value at a point that moves along two directions at once, its
/// slope along each, and its mixed second derivative. No differences, hence no step and no truncation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HyperDual {
    pub(crate) value: f64,
    pub(crate) first: [f64; 2],
    pub(crate) second: f64,
}

impl HyperDual {
    /// An unknown with its share of the two directions.
    pub(crate) fn moving(value: f64, first: [f64; 2]) -> Self {
        Self { value, first, second: 0.0 }
    }

    pub(crate) fn squared(self) -> Self {
        self * self
    }
}

impl From<f64> for HyperDual {
    fn from(value: f64) -> Self {
        Self::moving(value, [0.0; 2])
    }
}

impl Add for HyperDual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: [self.first[0] + other.first[0], self.first[1] + other.first[1]],
            second: self.second + other.second,
        }
    }
}

impl Neg for HyperDual {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for HyperDual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Sub<f64> for HyperDual {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl Mul for HyperDual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [a, b] = [self, other];
        Self {
            value: a.value * b.value,
            first: [0, 1].map(|i| a.first[i] * b.value + a.value * b.first[i]),
            second: a.second * b.value + a.first[0] * b.first[1] + a.first[1] * b.first[0] + a.value * b.second,
        }
    }
}

impl Mul<f64> for HyperDual {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, first: self.first.map(|f| f * factor), second: self.second * factor }
    }
}

impl Sum for HyperDual {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::default(), Add::add)
    }
}

/// `x y^2 - 3 x` at (2, 5) along (1, 4) and (7, -1), derivatives by hand.
#[test]
fn polynomial_has_the_derivatives_found_by_hand() {
    let x = HyperDual::moving(2.0, [1.0, 7.0]);
    let y = HyperDual::moving(5.0, [4.0, -1.0]);
    let f = x * y.squared() - x * 3.0;
    assert_eq!(f.value, 44.0);
    // The gradient is (y^2 - 3, 2 x y) = (22, 20), the second derivatives 0, 2 y = 10 and 2 x = 4.
    assert_eq!(f.first, [22.0 + 4.0 * 20.0, 7.0 * 22.0 - 20.0]);
    assert_eq!(f.second, 10.0 * (4.0 * 7.0 - 1.0) - 4.0 * 4.0);
    assert_eq!((HyperDual::from(3.0) - y).first, [-4.0, 1.0]);
}
