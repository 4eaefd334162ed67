//! Samples side by side in single precision.
//!
//! What uses a [`Pack`] has loops and no closures: these are compiled without the vector units' instructions where they are not inlined.

use std::ops::{Add, Mul, Sub};

use pulp::Simd;

/// Samples that are taken together.
pub(super) const GROUP: usize = 32;
/// Registers that are worked on together: while one waits for a product, the others go on.
const WIDE: usize = 2;

/// What the same operation gives for each register.
macro_rules! both {
    ($pack:ident, $w:ident => $value:expr) => {{
        let first = {
            let $w = 0;
            $value
        };
        let second = {
            let $w = 1;
            $value
        };
        $pack.with([first, second])
    }};
}

/// One number of every sample of some registers. Products and sums are rounded as the processor likes, so that the last digits depend on it.
#[derive(Clone, Copy)]
pub(super) struct Pack<S: Simd> {
    simd: S,
    values: [S::f32s; WIDE],
}

impl<S: Simd> Pack<S> {
    /// Samples that fit.
    pub(super) const COUNT: usize = if WIDE * S::F32_LANES < GROUP { WIDE * S::F32_LANES } else { GROUP };

    #[inline(always)]
    pub(super) fn all(simd: S, value: f32) -> Self {
        Self { simd, values: [simd.splat_f32s(value); WIDE] }
    }

    /// Those of the numbers of a group that the registers with this index take.
    #[inline(always)]
    pub(super) fn load(simd: S, values: &[f32; GROUP], index: usize) -> Self {
        let all = S::as_simd_f32s(values).0;
        let mut own = [simd.splat_f32s(0.0); WIDE];
        own.copy_from_slice(&all[index * WIDE..][..WIDE]);
        Self { simd, values: own }
    }

    #[inline(always)]
    pub(super) fn store(self, values: &mut [f32; GROUP], index: usize) {
        S::as_mut_simd_f32s(values).0[index * WIDE..][..WIDE].copy_from_slice(&self.values);
    }

    /// The same number for every sample.
    #[inline(always)]
    pub(super) fn same(self, value: f32) -> Self {
        Self::all(self.simd, value)
    }

    #[inline(always)]
    fn with(self, values: [S::f32s; WIDE]) -> Self {
        Self { simd: self.simd, values }
    }

    #[inline(always)]
    pub(super) fn over(self, other: Self) -> Self {
        both!(self, w => self.simd.div_f32s(self.values[w], other.values[w]))
    }

    /// `self + a b`.
    #[inline(always)]
    pub(super) fn plus_product(self, a: Self, b: Self) -> Self {
        both!(self, w => self.simd.mul_add_e_f32s(a.values[w], b.values[w], self.values[w]))
    }

    /// `self - a b`.
    #[inline(always)]
    pub(super) fn less_product(self, a: Self, b: Self) -> Self {
        both!(self, w => self.simd.negate_mul_add_e_f32s(a.values[w], b.values[w], self.values[w]))
    }

    /// What is left of a number of less than 2^20 after the nearest whole one is taken off.
    #[inline(always)]
    pub(super) fn off_whole(self) -> Self {
        // From here on, single precision has whole numbers alone.
        let large = self.same(12_582_912.0);
        self - ((self + large) - large)
    }

    /// Within -1/2 and 1/2.
    #[inline(always)]
    pub(super) fn within_half(self) -> Self {
        let (low, high) = (self.simd.splat_f32s(-0.5), self.simd.splat_f32s(0.5));
        let mut values = self.values;
        for value in &mut values {
            *value = self.simd.min_f32s(self.simd.max_f32s(*value, low), high);
        }
        self.with(values)
    }
}

/// Several polynomials at one place, the highest power first.
#[inline(always)]
pub(super) fn polynomials<S: Simd, const N: usize>(place: Pack<S>, powers: &[[f32; N]]) -> [Pack<S>; N] {
    let mut sums = [place.same(0.0); N];
    let [first, rest @ ..] = powers else { return sums };
    for n in 0..N {
        sums[n] = place.same(first[n]);
    }
    for row in rest {
        for n in 0..N {
            sums[n] = place.same(row[n]).plus_product(sums[n], place);
        }
    }
    sums
}

macro_rules! operator {
    ($trait:ident, $method:ident, $name:ident) => {
        impl<S: Simd> $trait for Pack<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                both!(self, w => self.simd.$name(self.values[w], other.values[w]))
            }
        }
    };
}

operator!(Add, add, add_f32s);
operator!(Sub, sub, sub_f32s);
operator!(Mul, mul, mul_f32s);
