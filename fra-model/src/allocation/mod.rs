//! Pressure allocation: the pressures of a bundle whose forces come closest to a desired wrench, within their limits.
//!
//! ```text
//! minimise  1/2 |W (J p - w)|^2 + h rho/2 |s - r|^2      s_i = (p_i - lower_i)/(upper_i - lower_i),  0 <= s <= 1
//! ```
//!
//! `r` are the shares of reference pressures, the lower limits unless [`Allocation::towards`] says otherwise.
//! `J` has a column for every pressure, the wrench that it adds per pascal; `W` weights the rows, so that newtons and newton metres are
//! added as numbers; `h` is the largest squared length of a column of `W J (upper - lower)`. In shares `s` the problem is a strictly convex
//! quadratic program in a box with the Hessian `H = (WJ)^T (WJ)/h + rho`. Without `rho > 0` the pressures nearest to the references of several equally good
//! ones would not be singled out: parallel actuators more than six always are such a case.
//!
//! First the limits that the pressures are at are taken for the active set, and all that turn out wrong are exchanged at once (block
//! pivoting): from the pressures of the last tick that is one step, nearly always. Where the exchange does not get fewer, Newton steps
//! within the limits follow: the whole step held to the limits (projected Newton, Bertsekas 1982), or, where that does not lower the
//! objective as it should, the step up to the first limit in its way, which joins the active set until the minimum on it is found, and only
//! then may limits be left. Each of these lowers the objective, so that no active set is minimised over twice, and the best one so far can
//! be used whenever time is up. `no_std`, no heap, no square root.

mod pivot;
mod solve;

use crate::number::real::{Real, epsilon, real};
use crate::parameters::{InvalidParameter, require};

/// Most pressures: one bit of an active set each.
const MOST: usize = 32;

/// A bundle's allocation problem for `R` components of the wrench and up to `N` pressures, ready for any wrench.
#[derive(Clone, Copy, Debug)]
pub struct Allocation<T, const R: usize, const N: usize> {
    count: usize,
    lower: [T; N],
    upper: [T; N],
    range: [T; N],
    weights: [T; R],
    /// `J`, a column for each pressure.
    jacobian: [[T; R]; N],
    /// `W J (upper - lower)`.
    columns: [[T; R]; N],
    /// Wrench of the lower limits.
    offset: [T; R],
    hessian: [[T; N]; N],
    /// `rho r`.
    pull: [T; N],
    /// `rho`.
    regulariser: T,
    /// `h`.
    scale: T,
}

/// Outcome of an allocation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AllocationStatus {
    /// The pressures are the minimum.
    Solved,
    /// The iteration stopped early: the pressures are within the limits and no worse than where it began.
    NotConverged,
    /// The wrench, or a result, is not finite: the pressures are the initial ones.
    NotFinite,
}

/// An allocation of pressures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allocated<T, const R: usize, const N: usize> {
    /// Outcome.
    pub status: AllocationStatus,
    /// Pressures in the unit of the limits, Pa; those beyond the problem's number of pressures are zero.
    pub pressures_pa: [T; N],
    /// The wrench they give, `J p`.
    pub wrench: [T; R],
    /// Residual of the conditions of Karush, Kuhn and Tucker: `max |s - clamp(s - (H s - g)/(1 + max|g|), 0, 1)|`.
    pub residual: T,
    /// Pressures at their lower limit, a bit each.
    pub at_lower: u32,
    /// Pressures at their upper limit, a bit each.
    pub at_upper: u32,
    /// Newton steps.
    pub iterations: u32,
}

impl<T: Real, const R: usize, const N: usize> Allocation<T, R, N> {
    /// Checks and prepares a problem.
    ///
    /// `columns[i]` is the wrench per pascal of pressure `i`, N/Pa and N m/Pa; `limits_pa[i]` its lowest
    /// and highest value; `weights` are 1/N and 1/(N m), >= 0. `regulariser` is `rho`, without unit: 1e-6 in `f64` and 1e-4 in `f32` leave
    /// that share of a reachable wrench, about.
    ///
    /// # Errors
    /// [`InvalidParameter`] for no or more than `N` (at most 32) columns, numbers that are not finite, a lower limit above the upper one, a
    /// negative weight, or a regulariser outside `64 n epsilon` to 1.
    pub fn new(
        columns: &[[T; R]],
        limits_pa: &[[T; 2]],
        weights: &[T; R],
        regulariser: T,
    ) -> Result<Self, InvalidParameter<T>> {
        check(columns, limits_pa, weights, regulariser, N)?;
        let zero = T::zero();
        let mut made = Self {
            count: columns.len(),
            lower: [zero; N],
            upper: [zero; N],
            range: [zero; N],
            weights: *weights,
            jacobian: [[zero; R]; N],
            columns: [[zero; R]; N],
            offset: [zero; R],
            hessian: [[zero; N]; N],
            pull: [zero; N],
            regulariser,
            scale: T::one(),
        };
        for (i, (column, [lower, upper])) in columns.iter().zip(limits_pa).enumerate().take(N) {
            (made.lower[i], made.upper[i], made.range[i]) = (*lower, *upper, *upper - *lower);
            made.jacobian[i] = *column;
            for (row, value) in column.iter().enumerate() {
                made.columns[i][row] = made.weights[row] * *value * made.range[i];
                made.offset[row] += *value * *lower;
            }
        }
        made.fill(regulariser);
        Ok(made)
    }

    /// The same problem, with pressures that the regulariser pulls to in place of the lower limits: of several equally good pressures the
    /// nearest to these are the minimum, each difference taken as a share of its range.
    ///
    /// `references_pa` has one for each pressure, Pa, within its limits.
    ///
    /// # Errors
    /// [`InvalidParameter`] for another number of references, or one outside of its limits.
    pub fn towards(mut self, references_pa: &[T]) -> Result<Self, InvalidParameter<T>> {
        let is_each = references_pa.len() == self.count;
        require(is_each, "references_pa", number(references_pa.len()), "one for every pressure")?;
        for (i, reference) in references_pa.iter().enumerate().take(N) {
            let is_within = *reference >= self.lower[i] && *reference <= self.upper[i];
            require(is_within, "references_pa", *reference, "within the limits of its pressure")?;
            // A range of zero leaves no choice.
            let share =
                if self.range[i] > T::zero() { (*reference - self.lower[i]) / self.range[i] } else { T::zero() };
            self.pull[i] = self.regulariser * share;
        }
        Ok(self)
    }

    /// Number of pressures.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The Hessian in shares.
    fn fill(&mut self, regulariser: T) {
        let columns = &self.columns[..self.count];
        let longest = columns.iter().map(|column| dot(column, column)).fold(T::zero(), T::max);
        if longest > T::zero() {
            self.scale = longest;
        }
        for i in 0..self.count {
            for j in 0..=i {
                let value = dot(&self.columns[i], &self.columns[j]) / self.scale;
                self.hessian[i][j] = value;
                self.hessian[j][i] = value;
            }
            self.hessian[i][i] += regulariser;
        }
    }

    /// The pressures that come closest to a wrench, from none.
    ///
    /// `wrench` in N and N m, in the order of the columns' components.
    pub fn solve(&self, wrench: &[T; R]) -> Allocated<T, R, N> {
        self.search(wrench, [T::zero(); N])
    }

    /// [`solve`](Self::solve), begun at earlier pressures: those of the last tick are one or two steps away. Ones outside of the limits
    /// begin at the limit, ones that are not finite at the lower one.
    pub fn solve_from(&self, pressures_pa: &[T; N], wrench: &[T; R]) -> Allocated<T, R, N> {
        let mut shares = [T::zero(); N];
        for i in 0..self.count {
            let share = (pressures_pa[i] - self.lower[i]) / self.range[i];
            if share.is_finite() {
                shares[i] = within(share);
            }
        }
        self.search(wrench, shares)
    }
}

/// The scalar product.
fn dot<T: Real, const R: usize>(a: &[T; R], b: &[T; R]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

/// A count as a number, without a double on the way.
fn number<T: Real>(count: usize) -> T {
    (0..count).fold(T::zero(), |sum, _| sum + T::one())
}

/// A share held to 0 to 1.
fn within<T: Real>(share: T) -> T {
    share.max(T::zero()).min(T::one())
}

fn check<T: Real, const R: usize>(
    columns: &[[T; R]],
    limits_pa: &[[T; 2]],
    weights: &[T; R],
    regulariser: T,
    capacity: usize,
) -> Result<(), InvalidParameter<T>> {
    let count = columns.len();
    let fits = count >= 1 && count <= capacity.min(MOST);
    require(fits, "columns", number(count), "from 1 to the capacity, at most 32")?;
    require(limits_pa.len() == count, "limits_pa", number(limits_pa.len()), "one pair for every column")?;
    for value in columns.iter().flatten() {
        require(value.is_finite(), "columns", *value, "finite")?;
    }
    for [lower, upper] in limits_pa {
        require(lower.is_finite(), "limits_pa", *lower, "finite")?;
        require(
            upper.is_finite() && *upper >= *lower,
            "limits_pa",
            *upper,
            "finite, the upper one not below the lower",
        )?;
    }
    for weight in weights {
        require(weight.is_finite() && *weight >= T::zero(), "weights", *weight, "finite and >= 0")?;
    }
    let least = real::<T>(64.0) * number(count) * epsilon::<T>();
    let held = regulariser >= least && regulariser <= T::one();
    require(held, "regulariser", regulariser, "64 n epsilon to 1")
}
