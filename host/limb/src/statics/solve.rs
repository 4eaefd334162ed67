//! The equilibrium under load that is connected to the limb without load.
//!
//! Newton's method with the tangent of the potential, while the loads grow. Each accepted shape is a minimum of the potential: its tangent
//! is positive definite. Where that ends, so does the answer.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3};
use thiserror::Error;

use super::newton_step::newton_step;
use super::rod::{Potential, Rod, SLOPES, UNKNOWNS};

/// Iterations of one load step; the longest turn of a piece in one iteration and in one load step, rad; the shortest load step.
const ITERATIONS: usize = 12;
pub(super) const LONGEST_TURN_RAD: f64 = 0.7;
const LEAST_STEP: f64 = 1e-4;
/// Steps are taken until they are below this, in strain and in rad.
const CONVERGED: f64 = 1e-10;

/// Which unknowns are free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bends {
    /// The bends of a piece are constant: six unknowns.
    Constant,
    /// They are linear: eight.
    Linear,
}

/// A shape in equilibrium.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The unknowns.
    pub q: DVector<f64>,
    /// The potential there.
    pub potential: Potential,
    /// Newton iterations and load steps.
    pub iterations: usize,
    /// Load steps.
    pub steps: usize,
}

/// Why there is no shape.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum EquilibriumError {
    /// The limb loses its stability.
    #[error("the limb loses its stability at {:.1} % of the load: the shape that it has without load ends there", 100.0 * share)]
    Unstable {
        /// Share of the load that it still carries.
        share: f64,
    },
}

impl Shape {
    /// Pose of the tip.
    pub fn tip(&self) -> Isometry3<f64> {
        self.potential.poses.last().copied().unwrap_or_else(Isometry3::identity)
    }

    /// How far the tip gives way to a small force on it, m/N: column by direction of the force.
    pub fn compliance_m_per_n(&self, rod: &Rod, bends: Bends) -> Option<Matrix3<f64>> {
        let tangent = self.held_tangent(bends).cholesky()?;
        let lever = self.levers(rod, bends);
        let given = [0, 1, 2].map(|axis: usize| tangent.solve(&lever[axis]));
        Some(Matrix3::from_fn(|row, column| lever[row].dot(&given[column])))
    }

    /// How the tip moves along each axis with the unknowns.
    pub(super) fn levers(&self, rod: &Rod, bends: Bends) -> [DVector<f64>; 3] {
        // A force is linear in the gradient: the difference that one newton makes is how the tip moves with the unknowns.
        let here = rod.potential(&self.q, 1.0).gradient;
        [0, 1, 2].map(|axis: usize| {
            let mut pushed = rod.clone();
            pushed.tip_force_n[axis] += 1.0;
            let mut lever = &here - pushed.potential(&self.q, 1.0).gradient;
            if bends == Bends::Constant {
                release(&mut lever);
            }
            lever
        })
    }

    /// The tangent with the unknowns that are not free taken out.
    pub(super) fn held_tangent(&self, bends: Bends) -> DMatrix<f64> {
        let mut tangent = self.potential.tangent.clone();
        hold(&mut tangent, bends);
        tangent
    }

    /// The least eigenvalue of the tangent relative to that without load: 1 without load, 0 where the shape loses its stability.
    pub fn stability(&self, rod: &Rod, bends: Bends) -> f64 {
        let mut unloaded = rod.potential(&DVector::zeros(rod.unknowns()), 0.0).tangent;
        let mut tangent = self.potential.tangent.clone();
        hold(&mut unloaded, bends);
        hold(&mut tangent, bends);
        least_relative(&tangent, unloaded)
    }
}

/// The least eigenvalue of a tangent relative to that without load.
pub(super) fn least_relative(tangent: &DMatrix<f64>, unloaded: DMatrix<f64>) -> f64 {
    let Some(root) = unloaded.cholesky() else { return f64::NEG_INFINITY };
    let root = root.l();
    let half = root.solve_lower_triangular(tangent).unwrap_or_else(|| tangent.clone());
    let both = root.solve_lower_triangular(&half.transpose()).unwrap_or(half);
    (0.5 * (&both + both.transpose())).symmetric_eigenvalues().min()
}

/// The shape under the full loads; from `start`, a shape under nearby loads, where that leads to one, else from the limb without load.
///
/// # Errors
/// [`EquilibriumError`] where the branch of stable shapes ends before the full load.
pub fn solve(rod: &Rod, bends: Bends, start: Option<&DVector<f64>>) -> Result<Shape, EquilibriumError> {
    let mut iterations = 0;
    if let Some(start) = start.filter(|start| start.len() == rod.unknowns())
        && let Some((q, potential)) = newton(rod, bends, start, 1.0, &mut iterations)
    {
        return Ok(Shape { q, potential, iterations, steps: 1 });
    }
    let mut q = DVector::zeros(rod.unknowns());
    let (mut share, mut step, mut steps) = (0.0, 1.0, 0);
    loop {
        let next: f64 = f64::min(share + step, 1.0);
        match newton(rod, bends, &q, next, &mut iterations) {
            Some((found, potential)) => {
                steps += 1;
                if next >= 1.0 {
                    return Ok(Shape { q: found, potential, iterations, steps });
                }
                (q, share, step) = (found, next, 2.0 * step);
            }
            None => step *= 0.5,
        }
        if step < LEAST_STEP {
            return Err(EquilibriumError::Unstable { share });
        }
    }
}

/// The next minimum of the potential; `None` where the tangent is not positive definite, a piece turns by too much, or it takes too long.
fn newton(
    rod: &Rod,
    bends: Bends,
    start: &DVector<f64>,
    share: f64,
    iterations: &mut usize,
) -> Option<(DVector<f64>, Potential)> {
    let mut q = start.clone();
    for _ in 0..ITERATIONS {
        *iterations += 1;
        let mut potential = rod.potential(&q, share);
        let step = if bends == Bends::Constant {
            release(&mut potential.gradient);
            let mut tangent = potential.tangent.clone();
            hold(&mut tangent, bends);
            newton_step(&tangent, &potential.gradient)?
        } else {
            newton_step(&potential.tangent, &potential.gradient)?
        };
        let size = size(rod, &step);
        if size <= CONVERGED {
            return Some((q, potential));
        }
        q -= step;
        if size > LONGEST_TURN_RAD || size_of_change(rod, &q, start) > LONGEST_TURN_RAD || !size.is_finite() {
            return None;
        }
    }
    None
}

fn size_of_change(rod: &Rod, q: &DVector<f64>, start: &DVector<f64>) -> f64 {
    size(rod, &(q - start))
}

/// Largest turn of a piece or strain in a step.
pub(super) fn size(rod: &Rod, step: &DVector<f64>) -> f64 {
    let of = |(index, value): (usize, &f64)| {
        let length_m = rod.pieces[index / UNKNOWNS].length_m;
        value.abs() * if index % UNKNOWNS < 5 { length_m } else { 1.0 }
    };
    step.iter().enumerate().map(of).fold(0.0, f64::max)
}

/// Takes the linear part of the bends out of a tangent.
fn hold(tangent: &mut DMatrix<f64>, bends: Bends) {
    if bends == Bends::Linear {
        return;
    }
    for piece in 0..tangent.nrows() / UNKNOWNS {
        for slope in SLOPES {
            let at = piece * UNKNOWNS + slope;
            tangent.row_mut(at).fill(0.0);
            tangent.column_mut(at).fill(0.0);
            tangent[(at, at)] = 1.0;
        }
    }
}

fn release(gradient: &mut DVector<f64>) {
    for piece in 0..gradient.len() / UNKNOWNS {
        SLOPES.iter().for_each(|slope| gradient[piece * UNKNOWNS + slope] = 0.0);
    }
}
