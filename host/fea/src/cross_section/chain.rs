//! The linear system of a section: every column is condensed to its two outer lines of nodes, then line after line is eliminated around
//! the section, then what all columns share.
//!
//! All of it is one elimination of a symmetric matrix, so that the negative pivots count the negative eigenvalues. At a stable
//! equilibrium there is one for each pressure mode and each held mean, and no other.

use super::build::{Build, Part};
use super::column::Column;
use super::front::{Front, Singular};
use super::grid::Grid;
use super::model::{Border, Form, State, springs};
use crate::elastomer::Elastomer;

/// A meshed section with room for its matrices.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) grid: Grid,
    pub(super) elastomer: Elastomer,
    pub(super) columns: Vec<Column>,
    condensed: Vec<Front>,
    lines: Vec<Front>,
    last: Front,
    strains: Front,
}

/// Result of one linear solve.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    /// Newton's step.
    pub(super) step: Form,
    /// Change by the pressure.
    pub(super) by_pressure: Form,
    /// Negative eigenvalues beyond those that a stable equilibrium has.
    pub(super) instabilities: usize,
    /// Stiffness by the four strains at constant pressure, rows and columns of held strains without the rest of the section.
    pub(super) stiffness: [[f64; 4]; 4],
    /// Change of the volume by the four strains at constant pressure.
    pub(super) lever: [f64; 4],
    /// Change of the volume by the pressure at constant load.
    pub(super) compliance: f64,
    /// Energy and enclosed volume.
    pub(super) energy: f64,
    pub(super) volume: f64,
}

impl Chain {
    pub(super) fn new(build: &Build, grid: Grid) -> Self {
        let mut columns = Vec::with_capacity(grid.columns());
        let mut spots = 0;
        for index in 0..grid.columns() {
            let column = Column::new(build, &grid, index, spots);
            spots += column.spots.len();
            columns.push(column);
        }
        let (nodes, border) = (grid.radii.len() * grid.dofs(), Border::len(&grid));
        let inner = nodes + 3 * grid.rings();
        // The three lines of a wedge are one, and its pressures stay with it.
        let (condensing, with_last) = if grid.part == Part::Wedge { (0, 3 * grid.rings()) } else { (inner, 0) };
        let condensed = vec![Front::new(inner + 2 * nodes + border, condensing); grid.columns()];
        let lines =
            (0..line_count(&grid)).map(|index| Front::new((1 + kept(&grid, index)) * nodes + border, nodes)).collect();
        let last = Front::new(nodes + with_last + border, nodes + with_last + border - 6);
        let free = grid.free().iter().filter(|free| **free).count();
        let strains = Front::new(free + 2, free);
        Self { grid, elastomer: build.elastomer, columns, condensed, lines, last, strains }
    }

    /// The undeformed state.
    pub(super) fn rest(&self) -> State {
        let spots = self.columns.last().map_or(0, |column| column.first_spot + column.spots.len());
        State { form: Form::rest(&self.grid), tensions: vec![[0.0; 2]; spots], pressure: 0.0 }
    }

    /// The tensions that belong to the fibers' strains after a change, to first order in it.
    pub(super) fn tensions_after(&self, form: &Form, change: &Form) -> Vec<[f64; 2]> {
        let columns = self.columns.iter().enumerate();
        columns.flat_map(|(index, column)| column.tensions_after(&self.grid, index, form, change)).collect()
    }

    /// Energy (of the Lagrangian with the pressure modes) and enclosed volume.
    pub(super) fn potential(&self, form: &Form) -> (f64, f64) {
        let each =
            self.columns.iter().enumerate().map(|(i, column)| column.potential(&self.grid, i, form, self.elastomer));
        each.fold((0.0, 0.0), |(energy, volume), (e, v)| (energy + e, volume + v))
    }

    /// Linearizes at a state under a load and solves.
    pub(super) fn solve(&mut self, state: &State, load: &[f64; 4]) -> Result<Linear, Singular> {
        let (mut energy, mut volume, mut negative) = (0.0, 0.0, 0);
        for (index, column) in self.columns.iter().enumerate() {
            let front = &mut self.condensed[index];
            let (e, v) = column.assemble(&self.grid, index, state, self.elastomer, front);
            (energy, volume) = (energy + e, volume + v);
            if index == 0 {
                add_springs(&self.grid, column, front);
            }
            negative += front.factor()?;
        }
        negative += self.eliminate_lines()?;
        negative += self.eliminate_last(load)?;
        negative += self.eliminate_strains()?;
        let modes = if self.grid.part == Part::Wedge { 2 } else { 3 };
        let expected = self.columns.len() * modes * self.grid.rings() + springs(self.grid.part).len();
        let border = self.last_border();
        Ok(Linear {
            step: self.substitute(border.residual, 0),
            by_pressure: self.substitute(border.by_pressure, 1),
            instabilities: negative.abs_diff(expected),
            stiffness: std::array::from_fn(|i| {
                std::array::from_fn(|j| self.last.get(border.strain + i, border.strain + j))
            }),
            lever: std::array::from_fn(|i| self.last.get(border.by_pressure, border.strain + i)),
            compliance: -self.strains.get(self.free() + 1, self.free() + 1),
            energy,
            volume,
        })
    }

    fn nodes(&self) -> usize {
        self.grid.radii.len() * self.grid.dofs()
    }

    /// The order of what all columns share in the last front.
    fn last_border(&self) -> Border {
        let pressures = if self.grid.part == Part::Wedge { 3 * self.grid.rings() } else { 0 };
        Border::of(&self.grid, self.nodes() + pressures)
    }

    fn free(&self) -> usize {
        self.grid.free().iter().filter(|free| **free).count()
    }

    fn eliminate_lines(&mut self) -> Result<usize, Singular> {
        let mut negative = 0;
        for index in 0..self.lines.len() {
            let (done, rest) = self.lines.split_at_mut(index);
            let front = &mut rest[0];
            let kept = kept(&self.grid, index);
            let map = |places: &[usize]| map(&self.grid, 1 + kept, places);
            front.clear();
            if self.grid.closed() {
                // The line to be eliminated, the first line, and the next one unless that is the first.
                let before = if index == 0 { &self.condensed[0] } else { &done[index - 1] };
                front.add_remainder(before, &map(&[1, 0]));
                front.add_remainder(&self.condensed[index + 1], &map(&[0, kept]));
            } else {
                if index > 0 {
                    front.add_remainder(&done[index - 1], &map(&[0]));
                }
                front.add_remainder(&self.condensed[index], &map(&[0, 1]));
                if index == 0 {
                    fix_mirrored(&self.grid, front);
                }
            }
            negative += front.factor()?;
        }
        Ok(negative)
    }

    fn eliminate_last(&mut self, load: &[f64; 4]) -> Result<usize, Singular> {
        self.last.clear();
        match self.lines.last() {
            Some(front) => self.last.add_remainder(front, &map(&self.grid, 1, &[0])),
            None => add_wedge(&self.grid, &self.condensed[0], &mut self.last),
        }
        if !self.grid.closed() {
            fix_mirrored(&self.grid, &mut self.last);
        }
        let border = self.last_border();
        for (strain, force) in load.iter().enumerate() {
            self.last.add(border.residual, border.strain + strain, *force);
        }
        self.last.factor()
    }

    fn eliminate_strains(&mut self) -> Result<usize, Singular> {
        let border = self.last_border();
        let free = (0..4).filter(|&strain| self.grid.free()[strain]).map(|strain| border.strain + strain);
        let from: Vec<usize> = free.chain([border.residual, border.by_pressure]).collect();
        self.strains.clear();
        for (i, &row) in from.iter().enumerate() {
            for (j, &column) in from[..=i].iter().enumerate() {
                self.strains.add(i, j, self.last.get(row, column));
            }
        }
        self.strains.factor()
    }

    /// All unknowns for one of the right-hand sides.
    fn substitute(&self, side_of_last: usize, side: usize) -> Form {
        let grid = &self.grid;
        let (nodes, free) = (self.nodes(), self.free());
        let mut form = Form::none(grid);
        let of_free = self.strains.substitute(free + side, &[]);
        let places = (0..4).filter(|&strain| grid.free()[strain]);
        places.zip(&of_free).for_each(|(strain, value)| form.strain[strain] = *value);
        let last = self.last.substitute(side_of_last, &form.strain);
        if grid.part == Part::Wedge {
            (0..2).for_each(|line| form.places[line * nodes..][..nodes].copy_from_slice(&last[..nodes]));
            form.pressures
                .iter_mut()
                .zip(last[nodes..].chunks(3))
                .for_each(|(modes, from)| modes.copy_from_slice(from));
            return form;
        }
        // What all columns share: multipliers, springs, strains.
        let shared: Vec<f64> = last[nodes..].iter().chain(&form.strain).copied().collect();
        let columns = self.columns.len();
        let mut lines = vec![Vec::new(); columns + 1];
        lines[if grid.closed() { 0 } else { columns }] = last[..nodes].to_vec();
        if grid.closed() {
            lines[columns] = lines[0].clone();
        }
        for index in (0..self.lines.len()).rev() {
            let line = if grid.closed() { index + 1 } else { index };
            let around = if grid.closed() { [&lines[0][..], &lines[line + 1]] } else { [&lines[line + 1][..], &[]] };
            let kept = kept(grid, index) * nodes;
            let stay: Vec<f64> = around.concat()[..kept].iter().chain(&shared).copied().collect();
            lines[line] = self.lines[index].substitute(nodes + kept + shared.len() + side, &stay);
        }
        for (column, front) in self.condensed.iter().enumerate() {
            let stay: Vec<f64> = lines[column].iter().chain(&lines[column + 1]).chain(&shared).copied().collect();
            let row = 3 * nodes + 3 * grid.rings() + shared.len() + side;
            let inner = front.substitute(row, &stay);
            form.places[(2 * column + 1) * nodes..][..nodes].copy_from_slice(&inner[..nodes]);
            for (element, modes) in inner[nodes..].chunks(3).enumerate() {
                form.pressures[column * grid.rings() + element].copy_from_slice(modes);
            }
            form.places[2 * column * nodes..][..nodes].copy_from_slice(&lines[column]);
        }
        if !grid.closed() {
            form.places[2 * columns * nodes..][..nodes].copy_from_slice(&lines[columns]);
        }
        form
    }
}

/// Lines of nodes that are eliminated one after the other.
fn line_count(grid: &Grid) -> usize {
    if grid.closed() { grid.columns() - 1 } else { grid.columns() }
}

/// Lines that stay while one is eliminated: the next one, and the first of a closed chain.
fn kept(grid: &Grid, index: usize) -> usize {
    if grid.closed() && index + 1 < line_count(grid) { 2 } else { 1 }
}

/// Places of the variables that a front keeps in one that has some lines: its lines to the given places, the border to the border.
fn map(grid: &Grid, lines: usize, places: &[usize]) -> Vec<usize> {
    let nodes = grid.radii.len() * grid.dofs();
    let of_lines = places.iter().flat_map(|place| place * nodes..(place + 1) * nodes);
    of_lines.chain(lines * nodes..lines * nodes + Border::len(grid)).collect()
}

/// The three lines of a wedge move alike; with that, the pressure that varies around has nothing to work on.
fn add_wedge(grid: &Grid, column: &Front, last: &mut Front) {
    let (nodes, pressures) = (grid.radii.len() * grid.dofs(), 3 * grid.rings());
    let (line, behind) = (0..nodes, nodes..nodes + pressures + Border::len(grid));
    let own = line.clone().chain(behind.clone().take(pressures));
    let map: Vec<usize> = own.chain(line.clone()).chain(line).chain(behind.skip(pressures)).collect();
    last.add_remainder(column, &map);
    (0..grid.rings()).for_each(|element| last.fix(nodes + 3 * element + 2));
}

/// Springs to the ground at the first line, which the border takes away again: with `t` the displacement of a spring,
/// `(u - t)^2/2` has no energy once `t` is free.
fn add_springs(grid: &Grid, column: &Column, front: &mut Front) {
    let start = 3 * grid.radii.len() * grid.dofs() + 3 * grid.rings();
    let border = Border::of(grid, start);
    for (spring, (inwards, dof)) in springs(grid.part).iter().enumerate() {
        let node = grid.radii.len() - 1 - inwards;
        let variable = column.node_start(grid, 0) + node * grid.dofs() + dof;
        front.add(variable, variable, 1.0);
        front.add(border.springs + spring, variable, -1.0);
        front.add(border.springs + spring, border.springs + spring, 1.0);
    }
}

/// On the plane of symmetry nothing moves around.
fn fix_mirrored(grid: &Grid, front: &mut Front) {
    for node in 0..grid.radii.len() {
        front.fix(node * grid.dofs() + 1);
    }
}
