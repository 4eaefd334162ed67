//! Contribution of one element to the equations.

use super::mesh::{FIELDS, NODES, PRESSURES};
use super::wall::{Energy, Gradient, PARTS, RR, RZ, TR, TT, TZ, Wall, Winding, ZR, ZZ, determinant};
use crate::quadrilateral::{Shape, quadratics};
use softlimb_numerics::gauss::GAUSS_3;

/// Unknowns of the nodes of an element, and all its unknowns.
const MOVES: usize = NODES * FIELDS;
pub(super) const ALL: usize = MOVES + PRESSURES;

/// A rectangle of the half-plane with the values of its unknowns.
pub(super) struct Element<'a> {
    pub(super) inner: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) values: &'a [f64; ALL],
}

/// An energy's derivatives by the unknowns of an element. Energies are divided by a full turn.
pub(super) struct Share {
    pub(super) first: [f64; ALL],
    pub(super) second: [[f64; ALL]; ALL],
}

/// A Gauss point: its gradient, and that gradient's derivatives by the moves of the nodes.
struct Point {
    f: Gradient,
    slopes: [[f64; MOVES]; PARTS],
    shape: Shape,
}

impl Share {
    pub(super) const NONE: Self = Self { first: [0.0; ALL], second: [[0.0; ALL]; ALL] };
}

impl Element<'_> {
    /// Adds the wall; `None` where it is turned inside out.
    pub(super) fn add_wall(&self, wall: &Wall, share: &mut Share) -> Option<()> {
        for (eta, along) in GAUSS_3 {
            for (xi, across) in GAUSS_3 {
                let radius = self.inner + 0.5 * self.width * (1.0 + xi);
                let weight = across * along * 0.25 * self.width * self.height * radius;
                let point = self.point(xi, eta);
                let weights: [f64; PRESSURES] = [1.0, xi, eta];
                let mean: f64 = weights.iter().zip(&self.values[MOVES..]).map(|(weight, p)| weight * p).sum();
                let mut energy = wall.energy(radius, &point.f);
                energy.add_pressure(mean, &point.f);
                let (j, cofactor) = determinant(&point.f);
                (j > 0.0).then_some(())?;
                self.add(&point, &energy, weight, share);
                for (k, p) in weights.iter().enumerate() {
                    share.first[MOVES + k] -= weight * p * (j - 1.0);
                    for i in 0..MOVES {
                        let slope: f64 = cofactor.iter().zip(&point.slopes).map(|(c, slopes)| c * slopes[i]).sum();
                        share.second[i][MOVES + k] -= weight * p * slope;
                        share.second[MOVES + k][i] -= weight * p * slope;
                    }
                }
            }
        }
        Some(())
    }

    /// Adds fibers on the inner (`xi = -1`) or the outer side (`xi = 1`).
    pub(super) fn add_sheet(&self, xi: f64, winding: &Winding, share: &mut Share) {
        let radius = self.inner + 0.5 * self.width * (1.0 + xi);
        for (eta, along) in GAUSS_3 {
            let point = self.point(xi, eta);
            let mut energy = Energy::NONE;
            winding.add_to(&mut energy, &point.f);
            self.add(&point, &energy, along * 0.5 * self.height * radius, share);
        }
    }

    /// The lumen's volume along the inner side, divided by a full turn.
    pub(super) fn lumen(&self) -> f64 {
        let mut volume = 0.0;
        for (eta, along) in GAUSS_3 {
            let (r, dz) = self.inner_side(eta);
            volume += along * 0.5 * r * r * dz;
        }
        volume
    }

    /// Radius of the inner side, and its axial place over `eta`.
    fn inner_side(&self, eta: f64) -> (f64, f64) {
        let (n, slopes) = quadratics(eta);
        let r = self.inner + (0..3).map(|k| n[k] * self.values[3 * k * FIELDS]).sum::<f64>();
        let dz = 0.5 * self.height + (0..3).map(|k| slopes[k] * self.values[3 * k * FIELDS + 2]).sum::<f64>();
        (r, dz)
    }

    /// Adds the potential `-P int r^2/2 dz` of a lumen on the inner side. A rigid cap adds nothing to it.
    pub(super) fn add_lumen(&self, pressure: f64, share: &mut Share) {
        let radial = |k: usize| 3 * k * FIELDS;
        let axial = |k: usize| 3 * k * FIELDS + 2;
        for (eta, along) in GAUSS_3 {
            let (n, slopes) = quadratics(eta);
            let (r, dz) = self.inner_side(eta);
            let factor = -pressure * along;
            for a in 0..3 {
                share.first[radial(a)] += factor * r * dz * n[a];
                share.first[axial(a)] += factor * 0.5 * r * r * slopes[a];
                for b in 0..3 {
                    share.second[radial(a)][radial(b)] += factor * dz * n[a] * n[b];
                    share.second[radial(a)][axial(b)] += factor * r * n[a] * slopes[b];
                    share.second[axial(b)][radial(a)] += factor * r * n[a] * slopes[b];
                }
            }
        }
    }

    /// The largest change of a displacement over the shorter side, `step` being a change of the unknowns.
    pub(super) fn change(&self, step: &[f64; ALL]) -> f64 {
        let spread = |field: usize| {
            let moves = (0..NODES).map(|node| step[node * FIELDS + field]);
            let (low, high) = moves.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), m| (a.min(m), b.max(m)));
            high - low
        };
        (0..FIELDS).map(spread).fold(0.0, f64::max) / self.width.min(self.height)
    }

    fn slopes(&self, shape: &Shape, node: usize) -> [f64; 2] {
        let [by_xi, by_eta] = shape.slopes[node];
        [by_xi * 2.0 / self.width, by_eta * 2.0 / self.height]
    }

    fn point(&self, xi: f64, eta: f64) -> Point {
        let shape = Shape::at(xi, eta);
        let radius = self.inner + 0.5 * self.width * (1.0 + xi);
        // Value and slopes of the three fields.
        let mut fields = [[0.0; 3]; FIELDS];
        for node in 0..NODES {
            let [by_radius, by_place] = self.slopes(&shape, node);
            for (field, sums) in fields.iter_mut().enumerate() {
                let value = self.values[node * FIELDS + field];
                sums[0] += shape.n[node] * value;
                sums[1] += by_radius * value;
                sums[2] += by_place * value;
            }
        }
        let [[u, u_r, u_z], [_, turn_r, turn_z], [_, z_r, z_z]] = fields;
        let r = radius + u;
        let mut f = [0.0; PARTS];
        (f[RR], f[RZ], f[TT]) = (1.0 + u_r, u_z, r / radius);
        (f[TR], f[TZ]) = (r * turn_r, r * turn_z);
        (f[ZR], f[ZZ]) = (z_r, 1.0 + z_z);
        let mut slopes = [[0.0; MOVES]; PARTS];
        for node in 0..NODES {
            let (n, [n_r, n_z]) = (shape.n[node], self.slopes(&shape, node));
            let [u, t, z] = [0, 1, 2].map(|field| node * FIELDS + field);
            (slopes[RR][u], slopes[RZ][u]) = (n_r, n_z);
            (slopes[TR][u], slopes[TT][u], slopes[TZ][u]) = (n * turn_r, n / radius, n * turn_z);
            (slopes[TR][t], slopes[TZ][t]) = (r * n_r, r * n_z);
            (slopes[ZR][z], slopes[ZZ][z]) = (n_r, n_z);
        }
        Point { f, slopes, shape }
    }

    /// Adds an energy at a Gauss point.
    fn add(&self, point: &Point, energy: &Energy, weight: f64, share: &mut Share) {
        for i in 0..MOVES {
            let mut row = [0.0; PARTS];
            for (part, slopes) in point.slopes.iter().enumerate() {
                let slope = weight * slopes[i];
                share.first[i] += slope * energy.first[part];
                row.iter_mut().zip(&energy.second[part]).for_each(|(sum, second)| *sum += slope * second);
            }
            for (j, entry) in share.second[i].iter_mut().enumerate().take(MOVES) {
                *entry += row.iter().zip(&point.slopes).map(|(stress, slopes)| stress * slopes[j]).sum::<f64>();
            }
        }
        // The turns enter the gradient times the radius, which is unknown as well.
        for b in 0..NODES {
            let [by_radius, by_place] = self.slopes(&point.shape, b);
            let stress = weight * (energy.first[TR] * by_radius + energy.first[TZ] * by_place);
            for a in 0..NODES {
                let mixed = point.shape.n[a] * stress;
                share.second[a * FIELDS][b * FIELDS + 1] += mixed;
                share.second[b * FIELDS + 1][a * FIELDS] += mixed;
            }
        }
    }
}

#[cfg(test)]
mod tests;
