//! One column of elements from the lumen to the outer surface: its points, and its matrix.

use super::build::{Build, Fibers, Wound};
use super::front::Front;
use super::grid::Grid;
use super::lumen::Lumen;
use super::model::{Border, Form, State};
use super::spot::{Local, Spot, Sums, V3};
use super::spots::{limiting_spots, places, surface_spots, wall_spot};
use crate::elastomer::Elastomer;
use softlimb_numerics::gauss::GAUSS_3;

/// Data of a column, computed once.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Directions of a node's displacements on the three lines: outwards, around, along.
    pub(super) frames: [[V3; 3]; 3],
    pub(super) spots: Vec<Spot>,
    /// First of its spots among those of all columns.
    pub(super) first_spot: usize,
    /// Weights of the three lines in the mean over the surface in whose middle the axis is.
    pub(super) mean: [f64; 3],
}

impl Column {
    pub(super) fn new(build: &Build, grid: &Grid, column: usize, first_spot: usize) -> Self {
        let angles: [f64; 3] = std::array::from_fn(|line| grid.angles[2 * column + line]);
        let frames = angles.map(|angle| {
            let (sin, cos) = angle.sin_cos();
            [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]
        });
        let mut spots = Vec::new();
        for element in 0..grid.rings() {
            let filling = build.windings.iter().filter(|(wound, _)| match *wound {
                Wound::From(radius) => 2 * element >= grid.node_at(radius),
                Wound::Sheet(_) => false,
            });
            let places = places(grid, &angles, element);
            for ((xi, u), (eta, v)) in GAUSS_3.iter().flat_map(|a| GAUSS_3.iter().map(move |b| (*a, *b))) {
                let mut spot = wall_spot(&places, element, xi, eta);
                spot.weight *= u * v * grid.multiplicity();
                let of_fibers = |fibers: Fibers| Spot { pressure: None, fibers: Some(fibers), ..spot.clone() };
                spots.extend(filling.clone().map(|(_, fibers)| of_fibers(*fibers)));
                spots.push(spot);
            }
        }
        for (wound, fibers) in &build.windings {
            if let Wound::Sheet(radius) = *wound {
                spots.extend(surface_spots(grid, &angles, grid.node_at(radius), Some(*fibers)));
            }
        }
        spots.extend(limiting_spots(build, grid, &angles, column));
        let length = (angles[2] - angles[0]) * grid.multiplicity();
        Self { frames, spots, first_spot, mean: [length / 6.0, length * 4.0 / 6.0, length / 6.0] }
    }

    /// Places of the nodes of an element.
    fn places(&self, grid: &Grid, form: &Form, column: usize, element: usize) -> [V3; 9] {
        std::array::from_fn(|node| {
            let at = form.node(grid, 2 * column + node / 3, 2 * element + node % 3);
            let frame = &self.frames[node / 3];
            std::array::from_fn(|axis| (0..grid.dofs()).map(|dof| at[dof] * frame[dof][axis]).sum())
        })
    }

    /// Calls `f(element, local, spots)` for every element with its spots.
    fn for_each_element(&self, grid: &Grid, column: usize, form: &Form, mut f: impl FnMut(usize, &Local)) {
        for element in 0..grid.rings() {
            let places = self.places(grid, form, column, element);
            let pressure = form.pressures[column * grid.rings() + element];
            let strain = &form.strain;
            f(element, &Local { dofs: grid.dofs(), frames: &self.frames, places: &places, strain, pressure });
        }
    }

    /// The tensions that the fibers' strains mean after a change, to first order in it.
    pub(super) fn tensions_after(&self, grid: &Grid, column: usize, form: &Form, change: &Form) -> Vec<[f64; 2]> {
        let mut tensions = vec![[0.0; 2]; self.spots.len()];
        self.for_each_element(grid, column, form, |element, local| {
            let moved = self.places(grid, change, column, element);
            for (tension, spot) in tensions.iter_mut().zip(&self.spots) {
                if let (true, Some(fibers)) = (spot.element == element, &spot.fibers) {
                    let (strain, slope) =
                        (local.fiber_strains(spot), local.fiber_strain_changes(spot, &moved, &change.strain));
                    *tension = std::array::from_fn(|family| fibers.stiffness * (strain[family] + slope[family]));
                }
            }
        });
        tensions
    }

    /// Energy without the derivatives, and the enclosed volume.
    pub(super) fn potential(&self, grid: &Grid, column: usize, form: &Form, elastomer: Elastomer) -> (f64, f64) {
        let (mut energy, mut volume) = (0.0, 0.0);
        self.for_each_element(grid, column, form, |element, local| {
            energy += self.spots_of(element).map(|(_, spot)| local.energy(elastomer, spot)).sum::<f64>();
            if element == 0 {
                volume += grid.multiplicity() * Lumen::of(local).volume;
            }
        });
        (energy, volume)
    }

    fn spots_of(&self, element: usize) -> impl Iterator<Item = (usize, &Spot)> {
        self.spots.iter().enumerate().filter(move |(_, spot)| spot.element == element)
    }

    /// Puts the column's matrix and right-hand sides together, and adds up energy and volume.
    pub(super) fn assemble(
        &self,
        grid: &Grid,
        column: usize,
        state: &State,
        elastomer: Elastomer,
        front: &mut Front,
    ) -> (f64, f64) {
        front.clear();
        let border = Border::of(grid, self.border_start(grid));
        let (mut energy, mut volume) = (0.0, 0.0);
        self.for_each_element(grid, column, &state.form, |element, local| {
            let mut sums = Sums::none();
            for (index, spot) in self.spots_of(element) {
                local.add(elastomer, spot, &state.tensions[self.first_spot + index], &mut sums);
            }
            energy += sums.energy;
            let variables = self.variables(grid, element, &border);
            if element == 0 {
                volume += self.add_lumen(grid, local, state.pressure, &variables, &border, &mut sums, front);
            }
            let pressures: [usize; 3] = std::array::from_fn(|mode| self.pressure_start(grid) + 3 * element + mode);
            scatter(&sums, &variables, &pressures, &border, front);
        });
        self.add_means(grid, &border, front);
        (energy, volume)
    }

    #[allow(clippy::too_many_arguments)]
    fn add_lumen(
        &self,
        grid: &Grid,
        local: &Local,
        pressure: f64,
        variables: &[usize],
        border: &Border,
        sums: &mut Sums,
        front: &mut Front,
    ) -> f64 {
        let lumen = Lumen::of(local);
        let times = grid.multiplicity();
        for (i, &variable) in variables.iter().enumerate() {
            front.add(border.by_pressure, variable, times * lumen.gradient[i]);
            sums.gradient[i] -= pressure * times * lumen.gradient[i];
            for j in 0..=i {
                sums.hessian[i][j] -= pressure * times * lumen.hessian[i][j];
            }
        }
        times * lumen.volume
    }

    /// The means over the surface in whose middle the axis is, one row for each.
    fn add_means(&self, grid: &Grid, border: &Border, front: &mut Front) {
        for line in 0..3 {
            for dof in 0..grid.dofs() {
                let variable = self.node_start(grid, line) + grid.axis_surface * grid.dofs() + dof;
                for (row, direction) in border.means(grid).iter().enumerate() {
                    let along = direction.component(&self.frames[line], dof);
                    front.add(border.gauge + row, variable, self.mean[line] * along);
                }
            }
        }
    }

    /// First variable of a line of nodes: the middle one comes first, then the pressures, the left and the right line.
    pub(super) fn node_start(&self, grid: &Grid, line: usize) -> usize {
        let nodes = grid.radii.len() * grid.dofs();
        let pressures = 3 * grid.rings();
        [nodes + pressures, 0, 2 * nodes + pressures][line]
    }

    pub(super) fn pressure_start(&self, grid: &Grid) -> usize {
        grid.radii.len() * grid.dofs()
    }

    pub(super) fn border_start(&self, grid: &Grid) -> usize {
        3 * grid.radii.len() * grid.dofs() + 3 * grid.rings()
    }

    /// Places of the displacements of an element and of the strains in the column.
    fn variables(&self, grid: &Grid, element: usize, border: &Border) -> Vec<usize> {
        let dofs = grid.dofs();
        let of_node = |node: usize| self.node_start(grid, node / 3) + (2 * element + node % 3) * dofs;
        let displacements = (0..9 * dofs).map(|local| of_node(local / dofs) + local % dofs);
        displacements.chain((0..4).map(|strain| border.strain + strain)).collect()
    }
}

/// Adds an element's sums to its column; the right-hand side is minus the gradient.
fn scatter(sums: &Sums, variables: &[usize], pressures: &[usize; 3], border: &Border, front: &mut Front) {
    for (i, &row) in variables.iter().enumerate() {
        front.add(border.residual, row, -sums.gradient[i]);
        for (j, &column) in variables[..=i].iter().enumerate() {
            front.add(row, column, sums.hessian[i][j]);
        }
        for (mode, &pressure) in pressures.iter().enumerate() {
            front.add(pressure, row, sums.coupling[i][mode]);
        }
    }
    for (mode, &pressure) in pressures.iter().enumerate() {
        front.add(border.residual, pressure, -sums.pressure_gradient[mode]);
    }
}
