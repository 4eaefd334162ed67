//! How the tip of a loaded shape moves when its rod changes: the implicit function theorem on the equilibrium.

use nalgebra::{DVector, Vector3};

use super::rod::Rod;
use super::solve::{Bends, Shape};

impl Shape {
    /// By how much the tip moves, to first order, where the rod of this shape becomes each of the others, m.
    ///
    /// With `g` the gradient of the potential and `K` its tangent, a change of the rod by `dg` at the same unknowns moves those by
    /// `-K^-1 dg` and the tip by what it moves at the same unknowns and by `dx/dq` times that. `None` where the tangent is not positive
    /// definite.
    pub fn tip_responses_m(&self, rod: &Rod, bends: Bends, others: &[Rod]) -> Option<Vec<Vector3<f64>>> {
        let tangent = self.held_tangent(bends).cholesky()?;
        let levers = self.levers(rod, bends).map(|lever| tangent.solve(&lever));
        let tip = self.tip().translation.vector;
        let response = |other: &Rod| {
            let there = other.potential(&self.q, 1.0);
            let change: DVector<f64> = &there.gradient - &self.potential.gradient;
            let moved = there.poses.last().map_or(tip, |pose| pose.translation.vector) - tip;
            moved - Vector3::from(levers.each_ref().map(|lever| lever.dot(&change)))
        };
        Some(others.iter().map(response).collect())
    }
}
