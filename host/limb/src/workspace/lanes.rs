//! Several samples side by side, in a vector register of the processor.

use std::ops::{Add, Mul, Neg, Sub};

use pulp::Simd;

/// Most samples side by side.
pub(super) const LANES: usize = 8;

/// One number of every sample. Sums and products are rounded one by one, so that results do not depend on the width of the register.
#[derive(Clone, Copy)]
pub(super) struct Pack<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Pack<S> {
    /// Samples that fit.
    pub(super) const COUNT: usize = if S::F64_LANES < LANES { S::F64_LANES } else { LANES };

    #[inline(always)]
    pub(super) fn all(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    /// The first of these numbers, as many as fit.
    #[inline(always)]
    pub(super) fn load(simd: S, values: &[f64; LANES]) -> Self {
        Self { simd, values: S::as_simd_f64s(values).0[0] }
    }

    #[inline(always)]
    pub(super) fn store(self) -> [f64; LANES] {
        let mut values = [0.0; LANES];
        S::as_mut_simd_f64s(&mut values).0[0] = self.values;
        values
    }

    /// The same number for every sample.
    #[inline(always)]
    pub(super) fn same(self, value: f64) -> Self {
        Self::all(self.simd, value)
    }

    #[inline(always)]
    fn with(self, values: S::f64s) -> Self {
        Self { simd: self.simd, values }
    }

    #[inline(always)]
    pub(super) fn over(self, other: Self) -> Self {
        self.with(self.simd.div_f64s(self.values, other.values))
    }

    /// The polynomial with these coefficients, the lowest power first.
    #[inline(always)]
    pub(super) fn polynomial(self, coefficients: &[f64]) -> Self {
        // No closure: it would be compiled without the vector units' instructions.
        let mut sum = self.same(0.0);
        for coefficient in coefficients.iter().rev() {
            sum = sum * self + self.same(*coefficient);
        }
        sum
    }
}

impl<S: Simd> Add for Pack<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(self.simd.add_f64s(self.values, other.values))
    }
}

impl<S: Simd> Sub for Pack<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(self.simd.sub_f64s(self.values, other.values))
    }
}

impl<S: Simd> Mul for Pack<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(self.simd.mul_f64s(self.values, other.values))
    }
}

impl<S: Simd> Neg for Pack<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.same(0.0) - self
    }
}
