//! The numbers the independent solver computes with: `f64`, pairs of `f64` (about 32 digits), and `f64` with derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the equations of the tube need of a number.
pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn of(value: f64) -> Self;
    fn of_pair(value: Pair) -> Self;
    fn value(self) -> f64;
    fn sqrt(self) -> Self;
    /// Cosine and sine.
    fn cos_sin(self) -> (Self, Self);
    fn cubed(self) -> Self {
        self * self * self
    }
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn of_pair(value: Pair) -> Self {
        value.high
    }
    fn value(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn cos_sin(self) -> (Self, Self) {
        (self.cos(), self.sin())
    }
}

/// An unevaluated sum of two `f64` that do not overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

fn quick_sum(a: f64, b: f64) -> Pair {
    let sum = a + b;
    Pair { high: sum, low: b - (sum - a) }
}

fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    (product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2)
}

impl Add for Pair {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, mut low) = two_sum(self.high, other.high);
        let (rest, last) = two_sum(self.low, other.low);
        low += rest;
        let first = quick_sum(high, low);
        quick_sum(first.high, first.low + last)
    }
}

impl Sub for Pair {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Pair {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Mul for Pair {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (high, low) = two_product(self.high, other.high);
        quick_sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Pair {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::of(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::of(second);
        quick_sum(first, second) + Self::of(rest.high / other.high)
    }
}

impl Number for Pair {
    fn of(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
    fn of_pair(value: Pair) -> Self {
        value
    }
    fn value(self) -> f64 {
        self.high
    }
    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::of(0.0);
        }
        let guess = Self::of(self.high.sqrt());
        // One Newton step doubles the digits of the guess.
        guess + (self - guess * guess) / (guess + guess)
    }
    /// Taylor series of an eighth of the angle, doubled three times: `1 - cos 2x = 2 sin^2 x`.
    fn cos_sin(self) -> (Self, Self) {
        let small = self * Self::of(0.125);
        let square = small * small;
        let (mut sine, mut versine) = (Self::of(0.0), Self::of(0.0));
        for k in (0..12).rev() {
            let k = f64::from(k);
            sine = Self::of(1.0) - square * sine / Self::of((2.0 * k + 2.0) * (2.0 * k + 3.0));
            versine = Self::of(1.0) - square * versine / Self::of((2.0 * k + 3.0) * (2.0 * k + 4.0));
        }
        (sine, versine) = (small * sine, square * versine * Self::of(0.5));
        for _ in 0..3 {
            let cosine = Self::of(1.0) - versine;
            (sine, versine) = (Self::of(2.0) * sine * cosine, Self::of(2.0) * sine * sine);
        }
        (Self::of(1.0) - versine, sine)
    }
}

/// A number and its derivatives with respect to `N` variables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<const N: usize> {
    pub(crate) value: f64,
    pub(crate) slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    pub(crate) fn variable(value: f64, index: usize) -> Self {
        let mut slopes = [0.0; N];
        slopes[index] = 1.0;
        Self { value, slopes }
    }

    #[inline(always)]
    fn map(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: self.slopes.map(|s| s * slope) }
    }

    #[inline(always)]
    fn join(self, other: Self, value: f64, by_self: f64, by_other: f64) -> Self {
        Self { value, slopes: std::array::from_fn(|i| by_self * self.slopes[i] + by_other * other.slopes[i]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|i| self.slopes[i] + other.slopes[i]);
        Self { value: self.value + other.value, slopes }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|i| self.slopes[i] - other.slopes[i]);
        Self { value: self.value - other.value, slopes }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.join(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.join(other, value, 1.0 / other.value, -value / other.value)
    }
}

impl<const N: usize> Number for Dual<N> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }
    fn of_pair(value: Pair) -> Self {
        Self::of(value.high)
    }
    fn value(self) -> f64 {
        self.value
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, 0.5 / root)
    }
    fn cos_sin(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.map(cos, -sin), self.map(sin, cos))
    }
}
