//! How the tip of a loaded shape moves when its rod changes: the implicit function theorem on the equilibrium.

use nalgebra::{Cholesky, DVector, Dyn, Vector3};

use super::newton_step::newton_step;
use super::rod::Rod;
use super::solve::{Bends, Shape};

/// A shape with the inverse of its tangent.
pub struct Responding<'a> {
    shape: &'a Shape,
    tangent: Cholesky<f64, Dyn>,
    levers: [DVector<f64>; 3],
}

impl Shape {
    /// The shape of a rod that differs a little, with linear bends, by one step of Newton's method from this one: right to first order in the
    /// difference. `None` where the tangent is not positive definite.
    pub fn beside(&self, rod: &Rod) -> Option<Self> {
        let there = rod.potential(&self.q, 1.0);
        let q = &self.q - newton_step(&there.tangent, &there.gradient)?;
        Some(Self { potential: rod.potential(&q, 1.0), q, iterations: 1, steps: 1 })
    }

    /// How the shape responds to changes of its rod; `None` where the tangent is not positive definite.
    pub fn responding(&self, rod: &Rod, bends: Bends) -> Option<Responding<'_>> {
        Some(Responding { shape: self, tangent: self.held_tangent(bends).cholesky()?, levers: self.levers(rod, bends) })
    }
}

impl Responding<'_> {
    /// By how much the tip, m, and the unknowns move, to first order, where the rod of the shape becomes another.
    ///
    /// With `g` the gradient of the potential and `K` its tangent, a change of the rod by `dg` at the same unknowns moves those by
    /// `-K^-1 dg` and the tip by what it moves at the same unknowns and by `dx/dq` times that.
    pub fn to(&self, other: &Rod) -> (Vector3<f64>, DVector<f64>) {
        let tip = self.shape.tip().translation.vector;
        let there = other.potential(&self.shape.q, 1.0);
        let change = -self.tangent.solve(&(&there.gradient - &self.shape.potential.gradient));
        let moved = there.poses.last().map_or(tip, |pose| pose.translation.vector) - tip;
        (moved + Vector3::from(self.levers.each_ref().map(|lever| lever.dot(&change))), change)
    }
}
