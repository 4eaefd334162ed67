//! The equilibrium under load that is connected to the limb at rest.
//!
//! Newton's method with the tangent of the potential, while pressures and loads grow together. Each accepted shape is a minimum of the potential: its tangent
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
/// Changes up to this are no jump to another shape, in strain and in rad; of larger ones Newton's first step is off by at most this share.
const NEAR: f64 = 0.2;
const STRAYS: f64 = 0.5;

/// The largest load factor that is looked for.
pub const LOAD_FACTOR_MAX: f64 = 4.0;
/// The longest and the shortest step towards it.
const LOAD_STEP: f64 = 0.25;
const LEAST_LOAD_STEP: f64 = 1e-3;

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
    #[error("the limb loses its stability at {:.1} % of its pressures and loads, which grow together", 100.0 * share)]
    Unstable {
        /// Share of pressures and loads that it still carries.
        share: f64,
    },
    /// A tube has no stable equilibrium at the strain that the load gives it.
    #[error("a tube of module {} has no stable equilibrium at the strain that the load gives it", module + 1)]
    Overstrained {
        /// Index of its module.
        module: usize,
    },
    /// Shape and springs do not agree with each other.
    #[error("the shape under the load and the springs of the tubes do not settle")]
    Unsettled,
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

    /// How far the tip gives way along an axis of the scene to a small force along it, m/N.
    pub fn compliance_along_m_per_n(&self, rod: &Rod, bends: Bends, axis: usize) -> Option<f64> {
        let mut pushed = rod.clone();
        pushed.tip_force_n[axis] += 1.0;
        let mut lever = &self.potential.gradient - pushed.potential(&self.q, 1.0).gradient;
        if bends == Bends::Constant {
            release(&mut lever);
        }
        Some(lever.dot(&newton_step(&self.held_tangent(bends), &lever)?))
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

    /// The share of all loads, at the pressures of the shape, at which the limb loses its stability, from 1 to [`LOAD_FACTOR_MAX`], which stands for
    /// that and more: the equilibrium is followed, in space, while the loads grow on.
    pub fn load_factor(&self, rod: &Rod, bends: Bends) -> f64 {
        self.load_factor_to(rod, bends, LOAD_FACTOR_MAX)
    }

    /// The same, followed no farther than to `most` >= 1, which stands for that and more.
    pub fn load_factor_to(&self, rod: &Rod, bends: Bends, most: f64) -> f64 {
        let (mut q, mut iterations) = (self.q.clone(), 0);
        follow_load(most, |share| {
            let found = newton(&rod.grown(share), bends, &q, &mut iterations);
            found.map(|(next, _)| q = next).is_some()
        })
    }
}

/// The largest share of the loads, from 1 to `most`, that steps from each share to the next reach; `reaches` takes a step.
pub(super) fn follow_load(most: f64, mut reaches: impl FnMut(f64) -> bool) -> f64 {
    let (mut share, mut step) = (1.0, LOAD_STEP);
    while share < most && step >= LEAST_LOAD_STEP {
        let next = f64::min(share + step, most);
        if reaches(next) {
            (share, step) = (next, f64::min(2.0 * step, LOAD_STEP));
        } else {
            step *= 0.5;
        }
    }
    share
}

/// The shape under the full loads; from `start`, a shape under nearby loads, where that leads to one, else from the limb at rest, whose pressures and
/// loads grow together.
///
/// # Errors
/// [`EquilibriumError`] where the path of stable shapes ends before the full load.
pub fn solve(rod: &Rod, bends: Bends, start: Option<&DVector<f64>>) -> Result<Shape, EquilibriumError> {
    let mut iterations = 0;
    if let Some(start) = start.filter(|start| start.len() == rod.unknowns())
        && let Some((q, potential)) = newton(rod, bends, start, &mut iterations)
    {
        return Ok(Shape { q, potential, iterations, steps: 1 });
    }
    follow(|share| rod.grown(share), rod.unknowns(), bends, iterations)
}

/// The shape that growing loads lead to from the limb at its full pressures: another one than [`solve`]'s where the limb has two.
///
/// # Errors
/// As [`solve`].
pub fn solve_pressurized(rod: &Rod, bends: Bends) -> Result<Shape, EquilibriumError> {
    follow(|share| rod.bearing(share), rod.unknowns(), bends, 0)
}

/// Follows the equilibria of `at`, whose argument grows from 0 to 1, from the shape without load.
fn follow(
    at: impl Fn(f64) -> Rod,
    unknowns: usize,
    bends: Bends,
    mut iterations: usize,
) -> Result<Shape, EquilibriumError> {
    let mut q = DVector::zeros(unknowns);
    let (mut share, mut step, mut steps) = (0.0, 1.0, 0);
    loop {
        let next: f64 = f64::min(share + step, 1.0);
        match newton(&at(next), bends, &q, &mut iterations) {
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

/// The next minimum of the potential; `None` where the tangent is not positive definite, a piece turns by too much, the shape is not the one that
/// the first step heads for, or it takes too long.
fn newton(rod: &Rod, bends: Bends, start: &DVector<f64>, iterations: &mut usize) -> Option<(DVector<f64>, Potential)> {
    let mut q = start.clone();
    let mut headed: Option<DVector<f64>> = None;
    for _ in 0..ITERATIONS {
        *iterations += 1;
        let mut potential = rod.potential(&q, 1.0);
        let step = if bends == Bends::Constant {
            release(&mut potential.gradient);
            let mut tangent = potential.tangent.clone();
            hold(&mut tangent, bends);
            newton_step(&tangent, &potential.gradient)?
        } else {
            newton_step(&potential.tangent, &potential.gradient)?
        };
        let size_of_step = size(rod, &step);
        if size_of_step <= CONVERGED {
            let strayed =
                |headed: &DVector<f64>| size_of_change(rod, &q, headed) > STRAYS * size_of_change(rod, headed, start);
            let near = size_of_change(rod, &q, start) <= NEAR;
            return (near || !headed.as_ref().is_some_and(strayed)).then_some((q, potential));
        }
        q -= step;
        headed.get_or_insert_with(|| q.clone());
        if size_of_step > LONGEST_TURN_RAD
            || size_of_change(rod, &q, start) > LONGEST_TURN_RAD
            || !size_of_step.is_finite()
        {
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
