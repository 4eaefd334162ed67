//! The largest load as a linear program, solved by Clarabel, with a certificate that does not rest on the solver.
//!
//! ```text
//! maximise t    sum_j C_j p_j + t l + c = 0,   lower <= p <= upper,   A p <= b
//! ```
//!
//! Any `y` with `y l = -1` and `z >= 0` bound `t` from above (weak duality):
//!
//! ```text
//! t <= y c + z b + sum_j max over lower_j <= p_j <= upper_j of (y C_j - z A_j) p_j
//! ```
//!
//! The bound is computed from the solver's multipliers in plain arithmetic, and the place found is moved to the vertex of the limits that
//! hold there. So value and bound meet to rounding, or the difference says by how much the answer may be off.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use nalgebra::{DMatrix, DVector};

use super::PayloadError;

/// A limit counts as met within this share of its range.
const MET: f64 = 1e-6;
/// By this share of the range a vertex may miss a limit.
const MISS: f64 = 1e-9;

/// A largest load. Rows are of any unit; `rows_scale` makes them comparable.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// `C`, a column for each pressure.
    pub columns: Vec<Vec<f64>>,
    /// `l`: what a unit of the load adds to each row.
    pub load: Vec<f64>,
    /// `c`: what is there without pressure and load.
    pub constant: Vec<f64>,
    /// Lowest and highest value of each pressure.
    pub limits: Vec<[f64; 2]>,
    /// Further limits `A p <= b`, a row of `A` and `b` each.
    pub sides: Vec<(Vec<f64>, f64)>,
    /// Sizes of the rows, > 0.
    pub rows_scale: Vec<f64>,
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// There is a largest load.
    Solved,
    /// No pressures balance the rows at any load.
    Infeasible,
    /// The rows balance at any load: nothing of it has to be held by pressure.
    Unbounded,
}

/// The answer to a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// How it ended; the rest is empty or zero unless solved.
    pub outcome: Outcome,
    /// The largest load.
    pub load: f64,
    /// The pressures there.
    pub pressures: Vec<f64>,
    /// The upper bound on the load that the multipliers certify.
    pub bound: f64,
    /// What is left of the rows, as a share of their sizes, at most.
    pub residual: f64,
    /// Steps of the interior-point method.
    pub iterations: u32,
}

/// The program in shares of the ranges, scaled rows and a scaled load.
struct Scaled {
    /// Rows of equations by `shares, load`.
    rows: DMatrix<f64>,
    right: DVector<f64>,
    /// Rows of `sides` by shares, and their bounds.
    sides: DMatrix<f64>,
    bounds: DVector<f64>,
    /// The load of one unit.
    unit: f64,
}

impl Program {
    /// Solves it.
    ///
    /// # Errors
    /// [`PayloadError::Solver`] where the solver fails.
    pub fn solve(&self) -> Result<Solution, PayloadError> {
        let count = self.columns.len();
        if self.load.iter().all(|load| *load == 0.0) {
            return Ok(self.without(Outcome::Unbounded, 0));
        }
        let scaled = self.scaled();
        let mut solver = scaled.solver()?;
        solver.solve();
        let found = &solver.solution;
        match found.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                return Ok(self.without(Outcome::Infeasible, found.iterations));
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
                return Ok(self.without(Outcome::Unbounded, found.iterations));
            }
            status => return Err(PayloadError::Solver(format!("{status:?}"))),
        }
        let place = scaled.vertex(&found.x).unwrap_or_else(|| found.x.clone());
        let share = |j: usize| place[j].clamp(0.0, 1.0);
        let pressure = |j: usize| {
            let [low, high] = self.limits[j];
            if share(j) >= 1.0 { high } else { low + (high - low) * share(j) }
        };
        let pressures: Vec<f64> = (0..count).map(pressure).collect();
        let load = place[count] * scaled.unit;
        let (equal, beside) = found.z.split_at(self.constant.len());
        Ok(Solution {
            outcome: Outcome::Solved,
            load,
            bound: self.bound(equal, &beside[2 * count..]),
            residual: self.residual(&pressures, load),
            pressures,
            iterations: found.iterations,
        })
    }

    fn without(&self, outcome: Outcome, iterations: u32) -> Solution {
        Solution { outcome, load: 0.0, pressures: Vec::new(), bound: 0.0, residual: 0.0, iterations }
    }

    fn scaled(&self) -> Scaled {
        let (count, height) = (self.columns.len(), self.constant.len());
        let range = |j: usize| self.limits[j][1] - self.limits[j][0];
        let at_low = |row: usize| (0..count).map(|j| self.columns[j][row] * self.limits[j][0]).sum::<f64>();
        let per_load = (0..height).map(|r| (self.load[r] / self.rows_scale[r]).abs()).fold(0.0, f64::max);
        let unit = 1.0 / per_load;
        let rows = DMatrix::from_fn(height, count + 1, |r, j| {
            let value = if j < count { self.columns[j][r] * range(j) } else { self.load[r] * unit };
            value / self.rows_scale[r]
        });
        let right = DVector::from_fn(height, |r, _| -(self.constant[r] + at_low(r)) / self.rows_scale[r]);
        let side = |k: usize| {
            let (row, bound) = &self.sides[k];
            let rest: f64 = (0..count).map(|j| row[j] * self.limits[j][0]).sum();
            let size = (0..count).map(|j| (row[j] * range(j)).abs()).fold((bound - rest).abs(), f64::max);
            (if size > 0.0 { size } else { 1.0 }, bound - rest)
        };
        let sides = DMatrix::from_fn(self.sides.len(), count, |k, j| self.sides[k].0[j] * range(j) / side(k).0);
        let bounds = DVector::from_fn(self.sides.len(), |k, _| side(k).1 / side(k).0);
        Scaled { rows, right, sides, bounds, unit }
    }

    /// The certified bound. Multipliers of rows and sides in the scaled problem; scaling undone.
    fn bound(&self, equal: &[f64], beside: &[f64]) -> f64 {
        let (count, height) = (self.columns.len(), self.constant.len());
        let y: Vec<f64> = (0..height).map(|r| equal[r] / self.rows_scale[r]).collect();
        let along: f64 = (0..height).map(|r| y[r] * self.load[r]).sum();
        let y: Vec<f64> = y.iter().map(|y| -y / along).collect();
        let sized = |k: usize| {
            let (row, bound) = &self.sides[k];
            let rest: f64 = (0..count).map(|j| row[j] * self.limits[j][0]).sum();
            let range = |j: usize| self.limits[j][1] - self.limits[j][0];
            (0..count).map(|j| (row[j] * range(j)).abs()).fold((bound - rest).abs(), f64::max)
        };
        // `along` also has the factor between the scaled objective and the load.
        let z: Vec<f64> = (0..self.sides.len())
            .map(|k| if sized(k) > 0.0 { beside[k].max(0.0) / sized(k) / along.abs() } else { 0.0 })
            .collect();
        let mut bound: f64 = (0..height).map(|r| y[r] * self.constant[r]).sum();
        bound += z.iter().zip(&self.sides).map(|(z, (_, b))| z * b).sum::<f64>();
        for j in 0..count {
            let mut slope: f64 = (0..height).map(|r| y[r] * self.columns[j][r]).sum();
            slope -= z.iter().zip(&self.sides).map(|(z, (row, _))| z * row[j]).sum::<f64>();
            let [low, high] = self.limits[j];
            bound += (slope * low).max(slope * high);
        }
        bound
    }

    fn residual(&self, pressures: &[f64], load: f64) -> f64 {
        let row = |r: usize| {
            let pushed: f64 = self.columns.iter().zip(pressures).map(|(column, p)| column[r] * p).sum();
            ((pushed + load * self.load[r] + self.constant[r]) / self.rows_scale[r]).abs()
        };
        (0..self.constant.len()).map(row).fold(0.0, f64::max)
    }
}

impl Scaled {
    fn solver(&self) -> Result<DefaultSolver<f64>, PayloadError> {
        let (height, width, sides) = (self.rows.nrows(), self.rows.ncols(), self.sides.nrows());
        let count = width - 1;
        let total = height + 2 * count + sides;
        let mut dense = DMatrix::zeros(total, width);
        let mut right = vec![0.0; total];
        dense.view_mut((0, 0), (height, width)).copy_from(&self.rows);
        right[..height].copy_from_slice(self.right.as_slice());
        for j in 0..count {
            // -s <= 0 and s <= 1.
            dense[(height + j, j)] = -1.0;
            dense[(height + count + j, j)] = 1.0;
            right[height + count + j] = 1.0;
        }
        dense.view_mut((height + 2 * count, 0), (sides, count)).copy_from(&self.sides);
        right[height + 2 * count..].copy_from_slice(self.bounds.as_slice());
        let mut linear = vec![0.0; width];
        linear[count] = -1.0;
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-11,
            tol_gap_rel: 1e-11,
            tol_feas: 1e-11,
            ..DefaultSettings::default()
        };
        let cones = [ZeroConeT(height), NonnegativeConeT(2 * count + sides)];
        let nothing = CscMatrix::zeros((width, width));
        DefaultSolver::new(&nothing, &linear, &sparse(&dense), &right, &cones, settings)
            .map_err(|error| PayloadError::Solver(error.to_string()))
    }

    /// The place moved to where the limits that it meets hold exactly; `None` where that leads out of others.
    fn vertex(&self, found: &[f64]) -> Option<Vec<f64>> {
        let (width, count) = (self.rows.ncols(), self.rows.ncols() - 1);
        let mut place = DVector::from_column_slice(found);
        let free: Vec<usize> =
            (0..width).filter(|j| *j == count || (found[*j] > MET && found[*j] < 1.0 - MET)).collect();
        (0..count).filter(|j| !free.contains(j)).for_each(|j| place[j] = place[j].round());
        let slack =
            |k: usize, place: &DVector<f64>| self.bounds[k] - self.sides.row(k).transpose().dot(&place.rows(0, count));
        let met: Vec<usize> = (0..self.sides.nrows()).filter(|k| slack(*k, &place) < MET).collect();
        let (height, all) = (self.rows.nrows(), self.rows.nrows() + met.len());
        let row = |r: usize, j: usize| match r.checked_sub(height) {
            None => self.rows[(r, j)],
            Some(k) if j < count => self.sides[(met[k], j)],
            Some(_) => 0.0,
        };
        let right = |r: usize| r.checked_sub(height).map_or_else(|| self.right[r], |k| self.bounds[met[k]]);
        let missing = DVector::from_fn(all, |r, _| right(r) - (0..width).map(|j| row(r, j) * place[j]).sum::<f64>());
        let part = DMatrix::from_fn(all, free.len(), |r, i| row(r, free[i]));
        // The least change where the vertex is no point.
        let change = part.svd(true, true).solve(&missing, 1e-12).ok()?;
        free.iter().zip(change.iter()).for_each(|(j, by)| place[*j] += by);
        let inside = place.iter().take(count).all(|s| (-MISS..=1.0 + MISS).contains(s));
        let beside = (0..self.sides.nrows()).all(|k| slack(k, &place) > -MISS);
        let moved = (place[count] - found[count]).abs() <= 1e-5 * (1.0 + found[count].abs());
        (inside && beside && moved).then(|| place.as_slice().to_vec())
    }
}

fn sparse(dense: &DMatrix<f64>) -> CscMatrix<f64> {
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in dense.column_iter() {
        for (row, value) in column.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            rows.push(row);
            values.push(*value);
        }
        starts.push(rows.len());
    }
    CscMatrix::new(dense.nrows(), dense.ncols(), starts, rows, values)
}
