//! Newton's step: the tangent factored and solved in one go, column by column, so that the vector units can work.

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

/// `tangent^-1 gradient` for a tangent that is positive definite, of which the lower triangle is looked at; else `None`.
pub(super) fn newton_step(tangent: &DMatrix<f64>, gradient: &DVector<f64>) -> Option<DVector<f64>> {
    let mut factor = tangent.as_slice().to_vec();
    let mut step = gradient.clone();
    let definite = Arch::new().dispatch(Solve { factor: &mut factor, step: step.as_mut_slice() });
    definite.then_some(step)
}

struct Solve<'a> {
    factor: &'a mut [f64],
    step: &'a mut [f64],
}

impl WithSimd for Solve<'_> {
    type Output = bool;

    /// The factors of `L D L^T`; each column is taken off the later ones as soon as it is known. What lies above the diagonal is of no account,
    /// so that whole registers can be taken.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { factor, step } = self;
        let count = step.len();
        for k in 0..count {
            let (known, later) = factor.split_at_mut((k + 1) * count);
            let column = &mut known[k * count..];
            let pivot = column[k];
            // Not a number is no pivot, either.
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let per = 1.0 / pivot;
            for (index, target) in (k + 1..).zip(later.chunks_exact_mut(count)) {
                take_off(simd, column[index] * per, &column[whole::<S>(index)..], &mut target[whole::<S>(index)..]);
            }
            column[k + 1..].iter_mut().for_each(|entry| *entry *= per);
            let own = step[k];
            step[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(to, from)| *to -= own * from);
            step[k] = own * per;
        }
        for k in (1..count).rev() {
            let (open, known) = step.split_at_mut(k);
            let row = factor[k..].iter().step_by(count);
            open.iter_mut().zip(row).for_each(|(to, from)| *to -= known[0] * from);
        }
        true
    }
}

/// Where the register begins that an index is in.
fn whole<S: Simd>(index: usize) -> usize {
    index - index % S::F64_LANES
}

/// `to - by from`.
#[inline(always)]
fn take_off<S: Simd>(simd: S, by: f64, from: &[f64], to: &mut [f64]) {
    let ((from, from_rest), (to, to_rest)) = (S::as_simd_f64s(from), S::as_mut_simd_f64s(to));
    let all = simd.splat_f64s(by);
    for (to, from) in to.iter_mut().zip(from) {
        *to = simd.sub_f64s(*to, simd.mul_f64s(all, *from));
    }
    to_rest.iter_mut().zip(from_rest).for_each(|(to, from)| *to -= by * from);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix whose inverse is known: `1 + u u^T` with that of Sherman and Morrison.
    #[test]
    fn known_inverse_is_found_and_what_is_not_definite_refused() {
        for count in [1, 2, 3, 8, 24, 27] {
            let u = DVector::from_fn(count, |i, _| 0.3 * (i as f64 + 1.0).sin());
            let right = DVector::from_fn(count, |i, _| (i as f64 * 0.7).cos());
            let matrix = DMatrix::identity(count, count) + &u * u.transpose();
            let expected = &right - &u * (u.dot(&right) / (1.0 + u.norm_squared()));
            let found = newton_step(&matrix, &right).expect("definite");
            assert!((found - expected).amax() < 1e-14);
            for bad in [-2.0, 0.0, f64::NAN] {
                let mut matrix = matrix.clone();
                matrix[(count - 1, count - 1)] = bad;
                assert!(newton_step(&matrix, &right).is_none(), "{count} {bad}");
            }
        }
    }
}
