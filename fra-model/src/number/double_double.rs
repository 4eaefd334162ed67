//! Double-double arithmetic: a number as the unevaluated sum of two floats.
//!
//! Sums, products, quotients and roots carry about twice the digits of `T`, by the error-free transformations of Dekker and Knuth;
//! transcendental functions by their series, and a Newton step on top of them.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::number::real::{Real, real};
use crate::number::scalar::Scalar;

/// Enough halvings for any argument whose exponential is finite, and enough terms for the digits of two `f64`.
const MOST_DOUBLINGS: u32 = 16;
const MOST_TERMS: u32 = 32;

/// `high + low` with `|low|` at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DoubleDouble<T> {
    pub(crate) high: T,
    pub(crate) low: T,
}

impl<T: Real> From<T> for DoubleDouble<T> {
    fn from(value: T) -> Self {
        Self { high: value, low: T::zero() }
    }
}

/// The exact sum.
#[inline]
fn two_sum<T: Real>(a: T, b: T) -> DoubleDouble<T> {
    let high = a + b;
    let part = high - a;
    DoubleDouble { high, low: (a - (high - part)) + (b - part) }
}

/// The exact sum where `|a| >= |b|`.
#[inline]
fn quick_two_sum<T: Real>(a: T, b: T) -> DoubleDouble<T> {
    let high = a + b;
    DoubleDouble { high, low: b - (high - a) }
}

/// Halves of a float whose products are exact.
#[inline]
fn split<T: Real>(a: T) -> (T, T) {
    let single = T::default_epsilon() > real::<T>(1e-9);
    let factor = if single { real::<T>(4097.0) } else { real::<T>(134_217_729.0) };
    let scaled = factor * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// The exact product.
#[inline]
fn two_product<T: Real>(a: T, b: T) -> DoubleDouble<T> {
    let high = a * b;
    let ((a1, a0), (b1, b0)) = (split(a), split(b));
    DoubleDouble { high, low: ((a1 * b1 - high) + a1 * b0 + a0 * b1) + a0 * b0 }
}

impl<T: Real> DoubleDouble<T> {
    /// The float nearest to it.
    pub(crate) fn round(self) -> T {
        self.high + self.low
    }

    /// `exp(x) - 1`: the series of a part of the argument, doubled up again.
    fn exp_m1(self) -> Self {
        let half = Self::from(real::<T>(0.5));
        let (mut part, mut doublings) = (self, 0);
        while part.abs() > Self::constant(0.125) && doublings < MOST_DOUBLINGS {
            (part, doublings) = (part * half, doublings + 1);
        }
        let (mut term, mut sum, mut order) = (part, part, Self::one());
        for _ in 0..MOST_TERMS {
            order += Self::one();
            term = term * part / order;
            sum += term;
            if term.abs() <= Self::rounding() * sum.abs() {
                break;
            }
        }
        for _ in 0..doublings {
            sum *= sum + Self::from(real::<T>(2.0));
        }
        sum
    }

    /// The series of sine or cosine from its first term, which has this order. Meant for angles up to a quarter turn.
    fn alternating_series(self, first: Self, order: Self) -> Self {
        let square = -(self * self);
        let (mut term, mut sum, mut order) = (first, first, order);
        for _ in 0..MOST_TERMS {
            term = term * square / ((order + Self::one()) * (order + Self::constant(2.0)));
            order += Self::constant(2.0);
            sum += term;
            if term.abs() <= Self::rounding() * sum.abs() {
                break;
            }
        }
        sum
    }
}

impl<T: Real> Add for DoubleDouble<T> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = quick_two_sum(high.high, high.low + low.high);
        quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl<T: Real> Neg for DoubleDouble<T> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl<T: Real> Sub for DoubleDouble<T> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<T: Real> Mul for DoubleDouble<T> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        quick_two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl<T: Real> Div for DoubleDouble<T> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        quick_two_sum(first, second) + Self::from(rest.high / other.high)
    }
}

impl<T: Real> AddAssign for DoubleDouble<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> SubAssign for DoubleDouble<T> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Real> MulAssign for DoubleDouble<T> {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Real> DivAssign for DoubleDouble<T> {
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<T: Real> PartialOrd for DoubleDouble<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.high.partial_cmp(&other.high)? {
            Ordering::Equal => self.low.partial_cmp(&other.low),
            decided => Some(decided),
        }
    }
}

impl<T: Real> Scalar for DoubleDouble<T> {
    #[inline]
    fn constant(value: f64) -> Self {
        Self::from(real::<T>(value))
    }

    fn epsilon() -> Self {
        Self::from(T::default_epsilon())
    }

    fn rounding() -> Self {
        Self::from(T::default_epsilon() * T::default_epsilon())
    }

    fn is_finite(self) -> bool {
        self.high.is_finite() && self.low.is_finite()
    }

    fn abs(self) -> Self {
        if self.high < T::zero() { -self } else { self }
    }

    fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root == T::zero() {
            return Self::from(root);
        }
        let rest = self - Self::from(root) * Self::from(root);
        quick_two_sum(root, rest.high / (root + root))
    }

    fn exp(self) -> Self {
        self.exp_m1() + Self::one()
    }

    fn ln(self) -> Self {
        (self - Self::one()).ln_1p()
    }

    /// One Newton step on `exp(y) - 1 = x` from the float's own logarithm.
    fn ln_1p(self) -> Self {
        let near = Self::from(self.high.ln_1p());
        let power = near.exp_m1();
        near - (power - self) / (power + Self::one())
    }

    fn sin(self) -> Self {
        self.alternating_series(self, Self::one())
    }

    fn cos(self) -> Self {
        self.alternating_series(Self::one(), Self::zero())
    }
}
