//! The volume that the tube encloses per length, with the derivatives that make the pressure's work and stiffness.
//!
//! A closed curve `y` in the section sweeps out, under the screw motion of stretch `l0` and rotation `w = (-k2, k1, tau)`,
//! `V = int [ (l0 e3 x y)/2 - |y|^2 w/2 ] . dy` per reference length, whatever surface it bounds, because the motion's velocity
//! `l0 e3 + w x y` is the curl of the integrand. The caps' share is in the dependence on `l0` and `w`.

use super::spot::{LOCAL, Local, V3, dot};
use crate::quadrilateral::quadratics;
use softlimb_numerics::gauss::GAUSS_3;

/// Enclosed volume of one element's inner face with its derivatives by displacements and strains.
pub(super) struct Lumen {
    pub(super) volume: f64,
    pub(super) gradient: [f64; LOCAL],
    /// Lower triangle.
    pub(super) hessian: [[f64; LOCAL]; LOCAL],
}

/// A displacement or a strain: its share of `y`, of `y'` and of the strains.
struct Column {
    index: usize,
    y: V3,
    slope: V3,
    strain: Option<usize>,
}

impl Lumen {
    /// Of the inner face of an element.
    pub(super) fn of(local: &Local) -> Self {
        let mut lumen = Self { volume: 0.0, gradient: [0.0; LOCAL], hessian: [[0.0; LOCAL]; LOCAL] };
        for (eta, weight) in GAUSS_3 {
            lumen.add(local, eta, weight);
        }
        lumen
    }

    fn add(&mut self, local: &Local, eta: f64, weight: f64) {
        let (n, slopes) = quadratics(eta);
        let [l0, k1, k2, tau] = *local.strain;
        let (mut y, mut t) = ([0.0; 3], [0.0; 3]);
        for line in 0..3 {
            for axis in 0..3 {
                let place = local.places[3 * line][axis];
                y[axis] += n[line] * place;
                t[axis] += slopes[line] * place;
            }
        }
        let turn = [-k2, k1, tau];
        let (square, along) = (dot(&y, &y), dot(&turn, &t));
        let area = 0.5 * (y[0] * t[1] - y[1] * t[0]);
        self.volume += weight * (l0 * area - 0.5 * square * along);

        let by_y = [0.5 * l0 * t[1] - y[0] * along, -0.5 * l0 * t[0] - y[1] * along, -y[2] * along];
        let by_t = [-0.5 * l0 * y[1], 0.5 * l0 * y[0], 0.0];
        let by_t: V3 = std::array::from_fn(|axis| by_t[axis] - 0.5 * square * turn[axis]);
        let by_strain = [area, -0.5 * square * t[1], 0.5 * square * t[0], -0.5 * square * t[2]];
        // What a strain does to the turn, whose components are -k2, k1 and tau.
        let turned: [V3; 4] = [[0.0; 3], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];

        let columns = columns(local, &n, &slopes);
        for (row, a) in columns.iter().enumerate() {
            let strain = a.strain.map_or(0.0, |strain| by_strain[strain]);
            self.gradient[a.index] += weight * (dot(&by_y, &a.y) + dot(&by_t, &a.slope) + strain);
            for b in &columns[..=row] {
                let second = match (a.strain, b.strain) {
                    (None, None) => {
                        let swept =
                            a.y[0] * b.slope[1] - a.y[1] * b.slope[0] + b.y[0] * a.slope[1] - b.y[1] * a.slope[0];
                        let turning = dot(&y, &a.y) * dot(&turn, &b.slope) + dot(&y, &b.y) * dot(&turn, &a.slope);
                        0.5 * l0 * swept - turning - dot(&a.y, &b.y) * along
                    }
                    (Some(0), None) => 0.5 * (b.y[0] * t[1] - b.y[1] * t[0] + y[0] * b.slope[1] - y[1] * b.slope[0]),
                    (Some(strain), None) => {
                        -dot(&y, &b.y) * dot(&turned[strain], &t) - 0.5 * square * dot(&turned[strain], &b.slope)
                    }
                    _ => 0.0,
                };
                self.hessian[a.index][b.index] += weight * second;
            }
        }
    }
}

fn columns(local: &Local, n: &[f64; 3], slopes: &[f64; 3]) -> Vec<Column> {
    let mut columns = Vec::with_capacity(13);
    for line in 0..3 {
        for (axis, direction) in local.frames[line][..local.dofs].iter().enumerate() {
            columns.push(Column {
                index: local.dofs * 3 * line + axis,
                y: direction.map(|entry| n[line] * entry),
                slope: direction.map(|entry| slopes[line] * entry),
                strain: None,
            });
        }
    }
    let strains = (0..4).map(|strain| Column {
        index: 9 * local.dofs + strain,
        y: [0.0; 3],
        slope: [0.0; 3],
        strain: Some(strain),
    });
    columns.extend(strains);
    columns
}
