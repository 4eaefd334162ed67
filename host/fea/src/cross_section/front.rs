//! Partial factorization of small dense symmetric indefinite matrices, of which the large system is put together.
//!
//! A front holds the variables to be eliminated first, the variables that stay, and right-hand sides as last rows. Eliminating the
//! right-hand sides' rows along with the rest leaves them ready for back substitution, so that one sweep does both.

/// Growth bound of the pivot choice, `(1 + sqrt 17)/8`.
const ALPHA: f64 = 0.640_388_203_202_208;

/// A dense symmetric matrix whose first variables are eliminated by `P A P^T = L D L^T` with pivots of order one and two.
#[derive(Clone, Debug)]
pub(super) struct Front {
    size: usize,
    eliminated: usize,
    /// Lower triangle by rows.
    a: Vec<f64>,
    /// Which variable stands at a position.
    order: Vec<usize>,
    /// Scratch: the pivot columns.
    columns: [Vec<f64>; 2],
}

/// The matrix has a pivot that is zero or not a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Singular;

impl Front {
    /// Zeros, of which the first `eliminated` variables can be eliminated.
    pub(super) fn new(size: usize, eliminated: usize) -> Self {
        let columns = [vec![0.0; size], vec![0.0; size]];
        Self { size, eliminated, a: vec![0.0; size * size], order: (0..size).collect(), columns }
    }

    pub(super) fn clear(&mut self) {
        self.a.fill(0.0);
        self.order.iter_mut().enumerate().for_each(|(position, variable)| *variable = position);
    }

    /// Adds to the entry of two variables. A pair is added once.
    pub(super) fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        self.a[row * self.size + column] += value;
    }

    pub(super) fn get(&self, i: usize, j: usize) -> f64 {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        self.a[row * self.size + column]
    }

    /// Adds what another front has left of the variables that stay, `map` saying where they are here.
    pub(super) fn add_remainder(&mut self, other: &Front, map: &[usize]) {
        for i in other.eliminated..other.size {
            let to = map[i - other.eliminated];
            let row = &other.a[i * other.size..][..=i];
            for j in other.eliminated..=i {
                let at = map[j - other.eliminated];
                // Two variables that become one: both halves of the matrix meet on the diagonal.
                let value = if to == at && i != j { 2.0 * row[j] } else { row[j] };
                self.add(to, at, value);
            }
        }
    }

    /// Holds a variable at the value it has.
    pub(super) fn fix(&mut self, variable: usize) {
        for other in 0..self.size {
            let (row, column) = if variable >= other { (variable, other) } else { (other, variable) };
            self.a[row * self.size + column] = 0.0;
        }
        self.a[variable * self.size + variable] = 1.0;
    }

    /// Eliminates; returns the number of negative eigenvalues of what is eliminated.
    pub(super) fn factor(&mut self) -> Result<usize, Singular> {
        let mut negative = 0;
        let mut k = 0;
        while k < self.eliminated {
            let (pivot, order) = self.choose(k);
            if order == 1 {
                self.swap(k, pivot);
                negative += self.eliminate_one(k)?;
            } else {
                self.swap(k + 1, pivot);
                negative += self.eliminate_two(k)?;
            }
            k += order;
        }
        Ok(negative)
    }

    /// The pivot of Bunch and Kaufman: its position and order.
    fn choose(&self, k: usize) -> (usize, usize) {
        let n = self.size;
        let at = |i: usize, j: usize| self.a[i * n + j].abs();
        let (mut largest, mut row) = (0.0, k);
        for i in k + 1..self.eliminated {
            if at(i, k) > largest {
                (largest, row) = (at(i, k), i);
            }
        }
        if at(k, k) >= ALPHA * largest {
            return (k, 1);
        }
        let left = (k..row).map(|j| at(row, j));
        let below = (row + 1..self.eliminated).map(|i| at(i, row));
        let of_row = left.chain(below).fold(0.0, f64::max);
        if at(k, k) * of_row >= ALPHA * largest * largest {
            (k, 1)
        } else if at(row, row) >= ALPHA * of_row {
            (row, 1)
        } else {
            (row, 2)
        }
    }

    fn eliminate_one(&mut self, k: usize) -> Result<usize, Singular> {
        let n = self.size;
        let pivot = self.a[k * n + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Singular);
        }
        let column = &mut self.columns[0];
        column.iter_mut().zip(self.a.chunks(n)).skip(k + 1).for_each(|(entry, row)| *entry = row[k]);
        let inverse = pivot.recip();
        for (i, row) in self.a.chunks_mut(n).enumerate().skip(k + 1) {
            let factor = column[i] * inverse;
            if factor != 0.0 {
                row[k] = factor;
                for (entry, w) in row[k + 1..=i].iter_mut().zip(&column[k + 1..=i]) {
                    *entry -= factor * w;
                }
            }
        }
        Ok(usize::from(pivot < 0.0))
    }

    fn eliminate_two(&mut self, k: usize) -> Result<usize, Singular> {
        let n = self.size;
        let (a, b, c) = (self.a[k * n + k], self.a[(k + 1) * n + k], self.a[(k + 1) * n + k + 1]);
        let determinant = a * c - b * b;
        if determinant == 0.0 || !determinant.is_finite() {
            return Err(Singular);
        }
        let [first, second] = &mut self.columns;
        for i in k + 2..n {
            first[i] = self.a[i * n + k];
            second[i] = self.a[i * n + k + 1];
        }
        self.a[(k + 1) * n + k] = 0.0;
        let inverse = determinant.recip();
        for i in k + 2..n {
            let x = (first[i] * c - second[i] * b) * inverse;
            let y = (second[i] * a - first[i] * b) * inverse;
            let row = &mut self.a[i * n + k..=i * n + i];
            (row[0], row[1]) = (x, y);
            let pivots = first[k + 2..=i].iter().zip(&second[k + 2..=i]);
            for (entry, (v, w)) in row[2..].iter_mut().zip(pivots) {
                *entry -= x * v + y * w;
            }
        }
        Ok(if determinant < 0.0 { 1 } else { 2 * usize::from(a + c < 0.0) })
    }

    /// Swaps two variables that are not yet eliminated.
    fn swap(&mut self, k: usize, p: usize) {
        if k == p {
            return;
        }
        let n = self.size;
        let (k, p) = (k.min(p), k.max(p));
        self.order.swap(k, p);
        for j in 0..k {
            self.a.swap(k * n + j, p * n + j);
        }
        self.a.swap(k * n + k, p * n + p);
        for j in k + 1..p {
            self.a.swap(j * n + k, p * n + j);
        }
        for i in p + 1..n {
            self.a.swap(i * n + k, i * n + p);
        }
    }

    /// Values of the eliminated variables for the right-hand side in row `side`, given those of the variables that stay, in order;
    /// rows beyond `stay` are other right-hand sides.
    pub(super) fn substitute(&self, side: usize, stay: &[f64]) -> Vec<f64> {
        let (n, eliminated) = (self.size, self.eliminated);
        let mut z = self.a[side * n..][..eliminated].to_vec();
        for (offset, value) in stay.iter().enumerate() {
            let row = &self.a[(eliminated + offset) * n..][..eliminated];
            z.iter_mut().zip(row).for_each(|(entry, l)| *entry -= value * l);
        }
        for i in (0..eliminated).rev() {
            let (before, rest) = z.split_at_mut(i);
            let row = &self.a[i * n..][..i];
            before.iter_mut().zip(row).for_each(|(entry, l)| *entry -= rest[0] * l);
        }
        let mut x = vec![0.0; eliminated];
        for (position, value) in z.into_iter().enumerate() {
            x[self.order[position]] = value;
        }
        x
    }
}
