//! The potential of `docs/explanation/cross-section.md`, section 1, written out a second time.
//!
//! Nothing of it is shared with the solver but where the nodes of the mesh are and which unknown is which: Cartesian gradients in place of
//! polar ones, the lumen as cones over its outline in place of an integral along it, parameters in their own units.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Placement};

use super::super::grid::Grid;
use super::super::options::{Limiter, Options, Winding};
use crate::hyper_dual::HyperDual;

type V3 = [HyperDual; 3];

fn dot(a: V3, b: V3) -> HyperDual {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: V3, b: V3) -> V3 {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// What an actuator is made of, and the unknowns of its section.
pub(super) struct Second<'a> {
    pub(super) parameters: &'a ActuatorParameters<f64>,
    pub(super) second_fiber: Option<Fiber<f64>>,
    pub(super) options: &'a Options,
    pub(super) grid: &'a Grid,
    /// Places, pressure modes and strains in the solver's order.
    pub(super) unknowns: &'a [HyperDual],
}

/// The polynomials through -1, 0 and 1 by Lagrange's product, and their slopes.
fn lagrange(x: f64) -> [[f64; 2]; 3] {
    let at = [-1.0, 0.0, 1.0];
    [0, 1, 2].map(|i| {
        let [a, b] = [at[(i + 1) % 3], at[(i + 2) % 3]];
        let unit = (at[i] - a) * (at[i] - b);
        [(x - a) * (x - b) / unit, (2.0 * x - a - b) / unit]
    })
}

/// Three points with their weights, and two.
fn gauss_3() -> [[f64; 2]; 3] {
    let far = 0.6f64.sqrt();
    [[-far, 5.0 / 9.0], [0.0, 8.0 / 9.0], [far, 5.0 / 9.0]]
}

fn gauss_2() -> [[f64; 2]; 2] {
    let far = (1.0f64 / 3.0).sqrt();
    [[-far, 1.0], [far, 1.0]]
}

impl Second<'_> {
    /// The strains of the axis, which come last.
    fn strain(&self) -> [HyperDual; 4] {
        std::array::from_fn(|i| self.unknowns[self.unknowns.len() - 4 + i])
    }

    /// Place of a node.
    fn place(&self, line: usize, radial: usize) -> V3 {
        let (grid, dofs) = (self.grid, self.grid.dofs());
        let first = ((line % grid.lines()) * grid.radii.len() + radial) * dofs;
        let (sin, cos) = grid.angles[line].sin_cos();
        let [outwards, around] = [self.unknowns[first], self.unknowns[first + 1]];
        let along = if dofs == 3 { self.unknowns[first + 2] } else { HyperDual::default() };
        [outwards * cos - around * sin, outwards * sin + around * cos, along]
    }

    /// Place of a node at rest.
    fn rest(&self, line: usize, radial: usize) -> [f64; 2] {
        let (sin, cos) = self.grid.angles[line].sin_cos();
        [self.grid.radii[radial] * cos, self.grid.radii[radial] * sin]
    }

    /// The third column of the deformation gradient: `l0 e3 + w x y`.
    fn carried(&self, y: V3) -> V3 {
        let [l0, k1, k2, tau] = self.strain();
        let [x, y, z] = cross([-k2, k1, tau], y);
        [x, y, z + l0]
    }

    /// `mu2/2 (I4 - 1)^2` summed over the families, by the images of the hoop and the axis; the modulus in units of the wall's.
    fn winding(&self, fiber: &Fiber<f64>, hoop: V3, axis: V3) -> HyperDual {
        let modulus = fiber.modulus_pa / self.parameters.material.shear_modulus_pa();
        let signs: &[f64] = if fiber.families == Families::Two { &[1.0, -1.0] } else { &[1.0] };
        let energy = |sign: &f64| {
            let (sin, cos) = (sign * fiber.angle_rad).sin_cos();
            let image = [0, 1, 2].map(|i| hoop[i] * cos + axis[i] * sin);
            (dot(image, image) - 1.0).squared() * (0.5 * modulus)
        };
        signs.iter().map(energy).sum()
    }

    /// The windings.
    fn fibers(&self) -> impl Iterator<Item = Fiber<f64>> {
        self.parameters.fiber.into_iter().chain(self.second_fiber)
    }

    /// `W(I1)` in units of the shear modulus.
    fn elastomer(&self, f: [V3; 3]) -> HyperDual {
        let x = f.map(|column| dot(column, column)).into_iter().sum::<HyperDual>() - 3.0;
        match self.parameters.material {
            Material::NeoHookean { .. } => x * 0.5,
            Material::Yeoh { c_pa: [c1, c2, c3] } => {
                let unit = 2.0 * c1;
                x * (c1 / unit) + x * x * (c2 / unit) + x * x * x * (c3 / unit)
            }
        }
    }

    /// The wall of one element, volume constraint included.
    fn wall(&self, column: usize, ring: usize) -> HyperDual {
        let nodes = self.grid.lines() * self.grid.radii.len() * self.grid.dofs();
        let first = nodes + 3 * (column * self.grid.rings() + ring);
        let mut sum = HyperDual::default();
        for [xi, of_xi] in gauss_3() {
            for [eta, of_eta] in gauss_3() {
                // Place, and slopes along xi and eta: at rest and now.
                let (mut rest, mut now) = ([[0.0; 2]; 3], [[HyperDual::default(); 3]; 3]);
                for (line, [b, db]) in lagrange(eta).into_iter().enumerate() {
                    for (radial, [a, da]) in lagrange(xi).into_iter().enumerate() {
                        let at = (2 * column + line, 2 * ring + radial);
                        let (from, to) = (self.rest(at.0, at.1), self.place(at.0, at.1));
                        for (k, weight) in [a * b, da * b, a * db].into_iter().enumerate() {
                            (0..2).for_each(|i| rest[k][i] += weight * from[i]);
                            (0..3).for_each(|i| now[k][i] = now[k][i] + to[i] * weight);
                        }
                    }
                }
                let [[x, y], [x_xi, y_xi], [x_eta, y_eta]] = rest;
                let area = x_xi * y_eta - y_xi * x_eta;
                let by_x = [0, 1, 2].map(|i| (now[1][i] * y_eta - now[2][i] * y_xi) * (1.0 / area));
                let by_y = [0, 1, 2].map(|i| (now[2][i] * x_xi - now[1][i] * x_eta) * (1.0 / area));
                let f = [by_x, by_y, self.carried(now[0])];
                let modes = [1.0, xi, eta];
                let pressure: HyperDual = (0..3).map(|mode| self.unknowns[first + mode] * modes[mode]).sum();
                let mut energy = self.elastomer(f) - pressure * (dot(cross(f[0], f[1]), f[2]) - 1.0);
                for fiber in self.fibers().filter(|fiber| self.fills(fiber, ring)) {
                    let radius = x.hypot(y);
                    let hoop = [0, 1, 2].map(|i| by_y[i] * (x / radius) - by_x[i] * (y / radius));
                    energy = energy + self.winding(&fiber, hoop, f[2]);
                }
                sum = sum + energy * (area * of_xi * of_eta);
            }
        }
        sum
    }

    /// Whether a ring of elements is full of fibers.
    fn fills(&self, fiber: &Fiber<f64>, ring: usize) -> bool {
        let inner_m = self.grid.radii[2 * ring] * self.parameters.inner_radius_m;
        match fiber.placement {
            Placement::Smeared => true,
            Placement::Layer => inner_m > fiber.radius_m - 1e-9,
            Placement::Sheet => false,
        }
    }

    /// An energy per length of a line of nodes in one column, from the images of the hoop and the axis.
    fn on_line(&self, column: usize, radial: usize, energy: impl Fn(V3, V3) -> HyperDual) -> HyperDual {
        let point = |[eta, weight]: [f64; 2]| {
            let (mut along, mut y, mut slope) = ([0.0; 2], [HyperDual::default(); 3], [HyperDual::default(); 3]);
            for (line, [b, db]) in lagrange(eta).into_iter().enumerate() {
                let (from, to) = (self.rest(2 * column + line, radial), self.place(2 * column + line, radial));
                (0..2).for_each(|i| along[i] += db * from[i]);
                (0..3).for_each(|i| (y[i], slope[i]) = (y[i] + to[i] * b, slope[i] + to[i] * db));
            }
            let length = along[0].hypot(along[1]);
            energy(slope.map(|s| s * (1.0 / length)), self.carried(y)) * (length * weight)
        };
        gauss_2().map(point).into_iter().sum()
    }

    /// The sheets in one column.
    fn sheets(&self, column: usize) -> HyperDual {
        let inner_m = self.parameters.inner_radius_m;
        if self.options.winding == Winding::Ideal {
            let hoop = |hoop, _| (dot(hoop, hoop) - 1.0).squared() * 0.5e7;
            return self.on_line(column, self.grid.radii.len() - 1, hoop);
        }
        let sheet = |fiber: Fiber<f64>| {
            let at = self.grid.radii.iter().position(|radius| (radius * inner_m - fiber.radius_m).abs() < 1e-12);
            let at = at.expect("nodes on the sheet");
            self.on_line(column, at, |hoop, axis| self.winding(&fiber, hoop, axis)) * (fiber.thickness_m / inner_m)
        };
        self.fibers().filter(|fiber| fiber.placement == Placement::Sheet).map(sheet).sum()
    }

    /// The strip in one column.
    fn strip(&self, column: usize) -> HyperDual {
        let Some(Limiter::Strip { half_angle_rad, stiffness_n_per_m }) = self.options.limiter else {
            return HyperDual::default();
        };
        if self.grid.angles[2 * column + 1].cos() < half_angle_rad.cos() {
            return HyperDual::default();
        }
        let unit = self.parameters.material.shear_modulus_pa() * self.parameters.inner_radius_m;
        let stiffness = stiffness_n_per_m / unit;
        self.on_line(column, self.grid.radii.len() - 1, |_, axis| (dot(axis, axis) - 1.0).squared() * (stiffness / 8.0))
    }

    /// The line that keeps its length, on the outermost node of the first line. The whole part has one.
    fn line(&self) -> HyperDual {
        if self.options.limiter != Some(Limiter::Line) {
            return HyperDual::default();
        }
        let axis = self.carried(self.place(0, self.grid.radii.len() - 1));
        (dot(axis, axis) - 1.0).squared() * 0.5e7
    }

    /// The flux of the screw motion's velocity through the cones that one column's inner face spans with the origin.
    fn lumen(&self, column: usize) -> HyperDual {
        let [l0, k1, k2, tau] = self.strain();
        let point = |[eta, weight]: [f64; 2]| {
            let (mut y, mut slope) = ([HyperDual::default(); 3], [HyperDual::default(); 3]);
            for (line, [b, db]) in lagrange(eta).into_iter().enumerate() {
                let to = self.place(2 * column + line, 0);
                (0..3).for_each(|i| (y[i], slope[i]) = (y[i] + to[i] * b, slope[i] + to[i] * db));
            }
            let normal = cross(y, slope);
            (l0 * normal[2] * 0.5 + dot(cross([-k2, k1, tau], y), normal) * (1.0 / 3.0)) * weight
        };
        gauss_3().map(point).into_iter().sum()
    }

    /// Energy with the constraint, and enclosed volume, both of the whole section.
    pub(super) fn sums(&self) -> [HyperDual; 2] {
        let grid = self.grid;
        let turn = grid.angles[grid.angles.len() - 1] - grid.angles[0];
        let times = (std::f64::consts::TAU / turn).round();
        let columns = 0..grid.columns();
        let walls = columns.clone().flat_map(|column| (0..grid.rings()).map(move |ring| (column, ring)));
        let wall: HyperDual = walls.map(|(column, ring)| self.wall(column, ring)).sum();
        let surfaces: HyperDual = columns.clone().map(|column| self.sheets(column) + self.strip(column)).sum();
        let lumen: HyperDual = columns.map(|column| self.lumen(column)).sum();
        [(wall + surfaces) * times + self.line(), lumen * times]
    }
}
