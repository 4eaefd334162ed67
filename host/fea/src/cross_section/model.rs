//! The unknowns of a meshed section and their order.

use super::build::Part;
use super::grid::Grid;
use super::spot::{V3, dot};

/// Places, pressures and strains; also a change of them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Form {
    /// Places of the nodes in the directions of their lines, outwards, around and along: by lines, then outwards.
    pub(super) places: Vec<f64>,
    /// Modes of the pressure in each element, by columns.
    pub(super) pressures: Vec<V3>,
    /// Stretch, the two bends and the twist of the axis.
    pub(super) strain: [f64; 4],
}

impl Form {
    /// The undeformed section.
    pub(super) fn rest(grid: &Grid) -> Self {
        let mut places = vec![0.0; grid.lines() * grid.radii.len() * grid.dofs()];
        for (node, place) in places.chunks_mut(grid.dofs()).enumerate() {
            place[0] = grid.radii[node % grid.radii.len()];
        }
        // The pressure that an incompressible body without stress needs: that of the shear modulus.
        let pressures = vec![[1.0, 0.0, 0.0]; grid.rings() * grid.columns()];
        Self { places, pressures, strain: [1.0, 0.0, 0.0, 0.0] }
    }

    /// Zero change.
    pub(super) fn none(grid: &Grid) -> Self {
        let mut none = Self::rest(grid);
        none.places.fill(0.0);
        none.pressures.fill([0.0; 3]);
        none.strain = [0.0; 4];
        none
    }

    /// A node on a line, which after a whole turn is the first one again.
    pub(super) fn node(&self, grid: &Grid, line: usize, radial: usize) -> &[f64] {
        let first = ((line % grid.lines()) * grid.radii.len() + radial) * grid.dofs();
        &self.places[first..][..grid.dofs()]
    }

    pub(super) fn add(&mut self, times: f64, change: &Form) {
        self.places.iter_mut().zip(&change.places).for_each(|(a, b)| *a += times * b);
        self.strain.iter_mut().zip(&change.strain).for_each(|(a, b)| *a += times * b);
        for (a, b) in self.pressures.iter_mut().zip(&change.pressures) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += times * b);
        }
    }

    /// The largest displacement or strain of a change; not a number if one of them is none.
    pub(super) fn largest(&self) -> f64 {
        let all = self.places.iter().chain(&self.strain);
        all.fold(0.0, |largest, value| if value.is_nan() { f64::NAN } else { f64::max(largest, value.abs()) })
    }
}

/// State of the iteration.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) form: Form,
    /// Tensions of the fibers at every spot, carried as unknowns of their own: a stiff fiber then makes the equations no more nonlinear.
    pub(super) tensions: Vec<[f64; 2]>,
    /// Gauge pressure.
    pub(super) pressure: f64,
}

/// A mean over the surface in whose middle the axis is, held at zero: what fixes where the axis is and which way it looks.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mean {
    Along(V3),
    Around,
}

impl Mean {
    /// The share of one displacement of a node.
    pub(super) fn component(&self, frame: &[V3; 3], dof: usize) -> f64 {
        match self {
            Self::Along(direction) => dot(direction, &frame[dof]),
            Self::Around => f64::from(u8::from(dof == 1)),
        }
    }
}

/// Order of the variables that all columns share, from a first index on: multipliers of the means, the springs' displacements, strains,
/// and the two right-hand sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub(super) gauge: usize,
    pub(super) springs: usize,
    pub(super) strain: usize,
    /// Right-hand sides: minus the gradient of the potential, and the gradient of the volume.
    pub(super) residual: usize,
    pub(super) by_pressure: usize,
}

impl Border {
    pub(super) fn of(grid: &Grid, start: usize) -> Self {
        let means = means(grid.part).len();
        let (springs, strain) = (start + means, start + 2 * means);
        Self { gauge: start, springs, strain, residual: strain + 4, by_pressure: strain + 5 }
    }

    /// All of them, the right-hand sides included.
    pub(super) fn len(grid: &Grid) -> usize {
        2 * means(grid.part).len() + 6
    }

    pub(super) fn means(&self, grid: &Grid) -> &'static [Mean] {
        means(grid.part)
    }
}

const X: Mean = Mean::Along([1.0, 0.0, 0.0]);
const Y: Mean = Mean::Along([0.0, 1.0, 0.0]);
const Z: Mean = Mean::Along([0.0, 0.0, 1.0]);

/// The rigid motions of a part at given strains.
pub(super) fn means(part: Part) -> &'static [Mean] {
    match part {
        Part::Wedge => &[Mean::Around],
        Part::Half => &[X],
        Part::Ring => &[X, Y, Z, Mean::Around],
    }
}

/// Displacements of nodes on the first line that hold the rigid motions while the chain of columns is eliminated, as (node from the
/// outside, direction).
pub(super) fn springs(part: Part) -> &'static [(usize, usize)] {
    match part {
        Part::Wedge => &[(0, 1)],
        Part::Half => &[(0, 0)],
        Part::Ring => &[(0, 0), (0, 1), (0, 2), (2, 1)],
    }
}
