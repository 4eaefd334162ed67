//! Linear systems with a narrow band.

/// A square matrix with entries near its diagonal only, factored in place with exchanges of rows.
pub(super) struct Band {
    size: usize,
    below: usize,
    /// Entries a row holds: the band and what exchanged rows add to it.
    width: usize,
    rows: Vec<f64>,
}

impl Band {
    /// A matrix of zeros with `reach` entries on each side of the diagonal.
    pub(super) fn new(size: usize, reach: usize) -> Self {
        let width = 3 * reach + 1;
        Self { size, below: reach, width, rows: vec![0.0; size * width] }
    }

    /// Adds to an entry within the band.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row * self.width + column + self.below - row] += value;
    }

    /// Solves for a right side, which becomes the solution; `None` for a singular matrix.
    pub(super) fn solve(mut self, right: &mut [f64]) -> Option<()> {
        for column in 0..self.size {
            self.eliminate(column, right)?;
        }
        for row in (0..self.size).rev() {
            let (pivot, after) = self.row(row, row).split_first()?;
            let sum: f64 = after.iter().zip(&right[row + 1..]).map(|(a, x)| a * x).sum();
            right[row] = (right[row] - sum) / pivot;
        }
        right.iter().all(|x| x.is_finite()).then_some(())
    }

    /// The entries of a row from a column on.
    fn row(&self, row: usize, column: usize) -> &[f64] {
        let start = row * self.width + column + self.below - row;
        &self.rows[start..(row + 1) * self.width]
    }

    fn eliminate(&mut self, column: usize, right: &mut [f64]) -> Option<()> {
        let last = (column + self.below + 1).min(self.size);
        let size = |row: usize| self.row(row, column)[0].abs();
        let best = (column..last).max_by(|a, b| size(*a).total_cmp(&size(*b)))?;
        if size(best) == 0.0 || !size(best).is_finite() {
            return None;
        }
        // Beyond this column the rows of the band have no entries.
        let reach = (2 * self.below + 1).min(self.size - column);
        let at = |row: usize| row * self.width + column + self.below - row;
        if best != column {
            right.swap(best, column);
            for k in 0..reach {
                self.rows.swap(at(best) + k, at(column) + k);
            }
        }
        let start = at(column);
        let pivot = self.rows[start];
        for row in column + 1..last {
            let (above, here) = self.rows.split_at_mut(row * self.width);
            let here = &mut here[column + self.below - row..];
            let factor = here[0] / pivot;
            if factor != 0.0 {
                here.iter_mut().zip(&above[start..start + reach]).for_each(|(a, b)| *a -= factor * b);
                right[row] -= factor * right[column];
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn system_with_zeros_on_its_diagonal_is_solved() {
        let (size, reach) = (40, 3);
        let entry = |i: usize, j: usize| if i == j { 0.0 } else { ((i * 7 + j * 13) % 11) as f64 - 4.5 };
        let wanted: Vec<f64> = (0..size).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut band = Band::new(size, reach);
        let mut right = vec![0.0; size];
        let near = |i: usize| (0..size).filter(move |j| i.abs_diff(*j) <= reach);
        for (i, right) in right.iter_mut().enumerate() {
            near(i).for_each(|j| band.add(i, j, entry(i, j)));
            *right = near(i).map(|j| entry(i, j) * wanted[j]).sum();
        }
        band.solve(&mut right).expect("regular");
        assert!(right.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-9), "{right:?}");
    }

    #[test]
    fn singular_system_is_refused() {
        let mut band = Band::new(3, 1);
        band.add(0, 0, 1.0);
        band.add(2, 2, 1.0);
        assert!(band.solve(&mut [1.0; 3]).is_none());
    }
}
