//! Block-tridiagonal systems of linear equations.

use nalgebra::{SMatrix, SVector};

pub(crate) type Block = SMatrix<f64, 6, 6>;
pub(crate) type Part = SVector<f64, 6>;

/// A block-tridiagonal matrix.
#[derive(Clone, Debug)]
pub(crate) struct Tridiagonal {
    pub(crate) diagonal: Vec<Block>,
    /// Blocks `(k, k + 1)`.
    pub(crate) above: Vec<Block>,
    /// Blocks `(k + 1, k)`.
    pub(crate) below: Vec<Block>,
}

impl Tridiagonal {
    pub(crate) fn zeros(count: usize) -> Self {
        let beside = vec![Block::zeros(); count.saturating_sub(1)];
        Self { diagonal: vec![Block::zeros(); count], above: beside.clone(), below: beside }
    }

    /// The solution for a right side; `None` where a pivot is singular.
    pub(crate) fn solve(&self, right: &[Part]) -> Option<Vec<Part>> {
        let count = self.diagonal.len();
        // Rows after elimination: `x_k + next_k x_(k+1) = value_k`.
        let mut rows: Vec<(Block, Part)> = Vec::with_capacity(count);
        for (index, (diagonal, own)) in self.diagonal.iter().zip(right).enumerate() {
            let (mut pivot, mut value) = (*diagonal, *own);
            if let Some((next, last)) = rows.last() {
                pivot -= self.below[index - 1] * next;
                value -= self.below[index - 1] * last;
            }
            let pivot = pivot.lu();
            let next = match self.above.get(index) {
                Some(above) => pivot.solve(above)?,
                None => Block::zeros(),
            };
            rows.push((next, pivot.solve(&value)?));
        }
        let mut found = vec![Part::zeros(); count];
        for index in (0..count).rev() {
            let (next, value) = &rows[index];
            let above = found.get(index + 1).copied().unwrap_or_default();
            found[index] = value - next * above;
        }
        Some(found)
    }

    /// Whether the symmetric part is positive definite.
    pub(crate) fn is_positive(&self) -> bool {
        let mut carried = Block::zeros();
        for (index, block) in self.diagonal.iter().enumerate() {
            let Some(pivot) = (0.5 * (block + block.transpose()) - carried).cholesky() else { return false };
            if let (Some(above), Some(below)) = (self.above.get(index), self.below.get(index)) {
                let beside = 0.5 * (above + below.transpose());
                carried = beside.transpose() * pivot.solve(&beside);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use softlimb_numerics::Random;

    fn system(seed: u64, diagonal: f64) -> (Tridiagonal, DMatrix<f64>) {
        let mut random = Random::new(seed, 0);
        let mut block = |added: f64| Block::from_fn(|_, _| random.uniform() - 0.5) + Block::identity() * added;
        let count = 5;
        let mut matrix = Tridiagonal::zeros(count);
        let mut dense = DMatrix::zeros(6 * count, 6 * count);
        for k in 0..count {
            matrix.diagonal[k] = block(diagonal);
            dense.fixed_view_mut::<6, 6>(6 * k, 6 * k).copy_from(&matrix.diagonal[k]);
            if k + 1 < count {
                (matrix.above[k], matrix.below[k]) = (block(0.0), block(0.0));
                dense.fixed_view_mut::<6, 6>(6 * k, 6 * k + 6).copy_from(&matrix.above[k]);
                dense.fixed_view_mut::<6, 6>(6 * k + 6, 6 * k).copy_from(&matrix.below[k]);
            }
        }
        (matrix, dense)
    }

    #[test]
    fn solution_is_that_of_the_dense_matrix() {
        for seed in 0..20 {
            let (matrix, dense) = system(seed, 3.0);
            let right: Vec<Part> = (0..5).map(|k| Part::from_fn(|row, _| (k * 7 + row) as f64 - 9.0)).collect();
            let found = matrix.solve(&right).unwrap();
            let expected = dense.lu().solve(&DVector::from_fn(30, |row, _| right[row / 6][row % 6])).unwrap();
            for row in 0..30 {
                assert!((found[row / 6][row % 6] - expected[row]).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn definiteness_is_that_of_the_dense_matrix() {
        let mut seen = [0, 0];
        for seed in 0..60 {
            let (matrix, dense) = system(seed, 1.5);
            let least = (&dense + dense.transpose()).symmetric_eigenvalues().min();
            assert_eq!(matrix.is_positive(), least > 0.0, "seed {seed}: {least}");
            seen[usize::from(least > 0.0)] += 1;
        }
        assert!(seen[0] > 3 && seen[1] > 3, "{seen:?}");
    }
}
