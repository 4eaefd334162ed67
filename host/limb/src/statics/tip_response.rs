//! How the tip of a loaded shape moves when its rod changes: the implicit function theorem on the equilibrium.

use nalgebra::{Cholesky, DVector, Dyn, Vector3};

use super::rod::Rod;
use super::solve::{Bends, Shape};

/// A shape with linear bends and the factors of its tangent: shapes of rods that differ a little, each by one step of Newton's method from this one.
#[derive(Clone, Debug)]
pub struct Neighbours {
    q: DVector<f64>,
    tangent: Cholesky<f64, Dyn>,
}

impl Neighbours {
    /// Change of the unknowns where the rod of the shape becomes another: right to first order in the difference.
    pub fn change(&self, other: &Rod) -> DVector<f64> {
        -self.tangent.solve(&other.potential(&self.q, 1.0).gradient)
    }

    /// The shape of another rod, whose unknowns differ by a known change.
    pub fn shape(&self, other: &Rod, change: &DVector<f64>) -> Shape {
        let q = &self.q + change;
        Shape { potential: other.potential(&q, 1.0), q, iterations: 1, steps: 1 }
    }

    /// The unknowns of the shape itself.
    pub fn q(&self) -> &DVector<f64> {
        &self.q
    }
}

/// A shape with the inverse of its tangent.
pub struct Responding<'a> {
    shape: &'a Shape,
    tangent: Cholesky<f64, Dyn>,
    levers: [DVector<f64>; 3],
}

impl Shape {
    /// The shape with the factors of its tangent; `None` where that is not positive definite.
    pub fn neighbours(&self) -> Option<Neighbours> {
        Some(Neighbours { q: self.q.clone(), tangent: self.potential.tangent.clone().cholesky()? })
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
