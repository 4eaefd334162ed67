//! Energy at one point of the section, with its derivatives by the displacements of an element and by the strains of the axis.
//!
//! The body is `x(S, X, Y) = g(S) y(X, Y)`, where `g(S)` is a screw motion of constant rates: stretch `l0` along the axis and rotation
//! `(-k2, k1, tau)` in the frame that travels along. In that frame the deformation gradient has the columns
//!
//! `F = [dy/dR, dy/(R dTheta), a]`, `a = (k1 y3 - tau y2, tau y1 + k2 y3, l0 - k1 y1 - k2 y2)`.

use super::build::Fibers;
use super::response::{Response, squared_stretch, stretched};
use crate::elastomer::Elastomer;

/// Vectors of three.
pub(super) type V3 = [f64; 3];

/// Displacements of an element and the four strains of the axis at most.
pub(super) const LOCAL: usize = 27 + 4;

pub(super) fn dot(a: &V3, b: &V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: &V3, b: &V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a` for a place, linear in it but for the stretch: the stretch is left out for a displacement.
pub(super) fn along(strain: &[f64; 4], y: &V3, stretch: f64) -> V3 {
    let [_, k1, k2, tau] = *strain;
    [k1 * y[2] - tau * y[1], tau * y[0] + k2 * y[2], stretch - k1 * y[0] - k2 * y[1]]
}

/// A point at which energy is collected: of the wall, of a fiber surface, or a fiber along the axis.
#[derive(Clone, Debug)]
pub(super) struct Spot {
    /// Its element in the column.
    pub(super) element: usize,
    /// Reference area that it stands for; length for a surface.
    pub(super) weight: f64,
    /// Shape functions and their derivatives outwards and around, per length.
    pub(super) n: [f64; 9],
    pub(super) slopes: [[f64; 2]; 9],
    /// Pressure modes where there is wall.
    pub(super) pressure: Option<V3>,
    /// The fibers here.
    pub(super) fibers: Option<Fibers>,
}

/// Sums over the spots of one element: energy, gradient and Hessian in displacements, strains and pressures.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    pub(super) energy: f64,
    pub(super) gradient: [f64; LOCAL],
    /// Lower triangle.
    pub(super) hessian: [[f64; LOCAL]; LOCAL],
    pub(super) pressure_gradient: V3,
    /// By displacements and strains, and a pressure.
    pub(super) coupling: [V3; LOCAL],
}

impl Sums {
    pub(super) fn none() -> Self {
        Self {
            energy: 0.0,
            gradient: [0.0; LOCAL],
            hessian: [[0.0; LOCAL]; LOCAL],
            pressure_gradient: [0.0; 3],
            coupling: [[0.0; 3]; LOCAL],
        }
    }
}

/// Present state of an element.
pub(super) struct Local<'a> {
    /// Displacements a node, two or three.
    pub(super) dofs: usize,
    /// Directions of the displacements on its three lines of nodes.
    pub(super) frames: &'a [[V3; 3]; 3],
    /// Places of its nodes.
    pub(super) places: &'a [V3; 9],
    /// Stretch, two bends, twist.
    pub(super) strain: &'a [f64; 4],
    /// Pressure modes.
    pub(super) pressure: V3,
}

/// Place and deformation gradient at a spot.
struct Kinematics {
    y: V3,
    f: [V3; 3],
}

/// Adds the work of a stress on every column up to the row's own. In a plane the axial shear and what leaves the plane are zero.
#[inline]
fn add_row(row: &mut [f64], stress: &[V3; 3], columns: &[[f64; LOCAL]; 9]) {
    let [[a, b, c], [d, e, f], [g, h, i]] = *stress;
    if [c, f, g, h] == [0.0; 4] {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += a * columns[0][j] + b * columns[1][j] + d * columns[3][j] + e * columns[4][j] + i * columns[8][j];
        }
        return;
    }
    for (j, entry) in row.iter_mut().enumerate() {
        *entry += a * columns[0][j]
            + b * columns[1][j]
            + c * columns[2][j]
            + (d * columns[3][j] + e * columns[4][j] + f * columns[5][j])
            + (g * columns[6][j] + h * columns[7][j] + i * columns[8][j]);
    }
}

impl Local<'_> {
    fn kinematics(&self, spot: &Spot) -> Kinematics {
        let (mut y, mut f) = ([0.0; 3], [[0.0; 3]; 3]);
        for node in 0..9 {
            for axis in 0..3 {
                let place = self.places[node][axis];
                y[axis] += spot.n[node] * place;
                f[0][axis] += spot.slopes[node][0] * place;
                f[1][axis] += spot.slopes[node][1] * place;
            }
        }
        f[2] = along(self.strain, &y, self.strain[0]);
        Kinematics { y, f }
    }

    /// `I4 - 1` of each family.
    pub(super) fn fiber_strains(&self, spot: &Spot) -> [f64; 2] {
        let at = self.kinematics(spot);
        spot.fibers
            .map_or([0.0; 2], |fibers| fibers.directions.map(|direction| squared_stretch(&at.f, direction) - 1.0))
    }

    /// Change of `I4` of each family when the nodes and the strains move.
    pub(super) fn fiber_strain_changes(&self, spot: &Spot, moved: &[V3; 9], strain: &[f64; 4]) -> [f64; 2] {
        let at = self.kinematics(spot);
        let by_place = Local { dofs: self.dofs, frames: self.frames, places: moved, strain, pressure: self.pressure }
            .kinematics(spot);
        // `a` is linear in the place and in the strains.
        let by_place_axial = along(self.strain, &by_place.y, 0.0);
        let by_strain_axial = along(strain, &at.y, strain[0]);
        let axial = std::array::from_fn(|axis| by_place_axial[axis] + by_strain_axial[axis]);
        let df = [by_place.f[0], by_place.f[1], axial];
        let change = |direction| 2.0 * dot(&stretched(&at.f, direction), &stretched(&df, direction));
        spot.fibers.map_or([0.0; 2], |fibers| fibers.directions.map(change))
    }

    /// The Lagrangian's share at one spot: energy without the derivatives.
    pub(super) fn energy(&self, elastomer: Elastomer, spot: &Spot) -> f64 {
        let f = self.kinematics(spot).f;
        let mut energy = 0.0;
        if let Some(modes) = &spot.pressure {
            let squares: f64 = f.iter().map(|column| dot(column, column)).sum();
            let volume = dot(&f[2], &cross(&f[0], &f[1]));
            energy += elastomer.at(squares - 3.0)[0] - dot(modes, &self.pressure) * (volume - 1.0);
        }
        if let Some(fibers) = &spot.fibers {
            for direction in &fibers.directions[..fibers.families] {
                let strain = squared_stretch(&f, *direction) - 1.0;
                energy += 0.5 * fibers.stiffness * strain * strain;
            }
        }
        spot.weight * energy
    }

    /// Adds one spot. `tensions` are those that the iteration carries for the fibers.
    pub(super) fn add(&self, elastomer: Elastomer, spot: &Spot, tensions: &[f64; 2], sums: &mut Sums) {
        let at = self.kinematics(spot);
        let columns = self.columns(spot, &at.y);
        let mut response =
            Response::new(&at.f, spot, elastomer, tensions, dot(&spot.pressure.unwrap_or([0.0; 3]), &self.pressure));
        response.scale(spot.weight);
        sums.energy += response.energy;
        let displacements = 9 * self.dofs;
        for row in 0..displacements + 4 {
            let df: [V3; 3] = std::array::from_fn(|column| std::array::from_fn(|axis| columns[3 * column + axis][row]));
            if df == [[0.0; 3]; 3] {
                continue;
            }
            sums.gradient[row] += response.work(&df);
            add_row(&mut sums.hessian[row][..=row], &response.stress_change(&df), &columns);
            if let Some(modes) = &spot.pressure {
                let change = response.volume_change(&df);
                sums.coupling[row].iter_mut().zip(modes).for_each(|(sum, mode)| *sum -= mode * change);
            }
        }
        if let Some(modes) = &spot.pressure {
            let sums = sums.pressure_gradient.iter_mut().zip(modes);
            sums.for_each(|(sum, mode)| *sum -= mode * response.volume_excess);
        }
        self.add_mixed(spot, &response.carried_axial, displacements, sums);
    }

    /// The nine components of `dF`, each by every displacement and strain.
    fn columns(&self, spot: &Spot, y: &V3) -> [[f64; LOCAL]; 9] {
        let mut columns = [[0.0; LOCAL]; 9];
        for node in 0..9 {
            let (n, [outwards, around]) = (spot.n[node], spot.slopes[node]);
            for (axis, direction) in self.frames[node / 3][..self.dofs].iter().enumerate() {
                let index = self.dofs * node + axis;
                let axial = along(self.strain, direction, 0.0);
                for component in 0..3 {
                    columns[component][index] = outwards * direction[component];
                    columns[3 + component][index] = around * direction[component];
                    columns[6 + component][index] = n * axial[component];
                }
            }
        }
        let by_strain = [[0.0, 0.0, 1.0], [y[2], 0.0, -y[0]], [0.0, y[2], -y[1]], [-y[1], y[0], 0.0]];
        for (strain, change) in by_strain.into_iter().enumerate() {
            for component in 0..3 {
                columns[6 + component][9 * self.dofs + strain] = change[component];
            }
        }
        columns
    }

    /// The stress times the second derivative of `F`, which is that of `a` by a displacement and a strain.
    fn add_mixed(&self, spot: &Spot, axial: &V3, displacements: usize, sums: &mut Sums) {
        for node in 0..9 {
            if spot.n[node] == 0.0 {
                continue;
            }
            for (axis, d) in self.frames[node / 3][..self.dofs].iter().enumerate() {
                let column = self.dofs * node + axis;
                let n = spot.n[node];
                sums.hessian[displacements + 1][column] += n * (d[2] * axial[0] - d[0] * axial[2]);
                sums.hessian[displacements + 2][column] += n * (d[2] * axial[1] - d[1] * axial[2]);
                sums.hessian[displacements + 3][column] += n * (d[0] * axial[1] - d[1] * axial[0]);
            }
        }
    }
}
