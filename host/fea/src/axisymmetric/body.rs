//! The finite element equations of a wall's half-plane, and equilibrium under rising pressure.

use fra_model::Families;

use super::band::Band;
use super::element::{ALL, Element, Share};
use super::mesh::{EndOfWall, FIELDS, Mesh, Numbers};
use super::wall::{Wall, Winding};
use crate::quadrilateral::quadratics;

/// Newton steps for one increment of the pressure.
const NEWTON_STEPS: u32 = 25;
/// First increment as a share of the pressure, and the smallest one to go on with.
const FIRST_PART: f64 = 0.05;
const LEAST_PART: f64 = 1e-4;
/// Most that the growth of the lumen per pressure may grow from one increment to the next: more is another branch, or the way there.
const LARGEST_GROWTH: f64 = 2.5;
/// Largest change of a deformation gradient in one Newton step.
const LARGEST_CHANGE: f64 = 0.3;
/// A correction of the deformation gradient below this is rounding.
const TOLERANCE: f64 = 1e-11;

/// A part of the wall between its plane of symmetry and its end, lengths in units of the inner radius, stresses of the shear modulus.
pub(super) struct Body {
    pub(super) wall: Wall,
    pub(super) mesh: Mesh,
    pub(super) end: EndOfWall,
    /// Fibers on a part of the surface at a radius, from the plane of symmetry to an axial place.
    pub(super) band: Option<(f64, f64, Winding)>,
}

/// An equilibrium: the values of all unknowns.
pub(super) struct Shaped {
    numbers: Numbers,
    values: Vec<f64>,
}

/// There is no equilibrium at the pressure asked for; the last pressure that has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoEquilibrium {
    pub(super) last: f64,
}

impl Body {
    /// The equilibrium under a gauge pressure on the lumen, reached from zero.
    pub(super) fn inflate(&self, pressure: f64) -> Result<Shaped, NoEquilibrium> {
        let band_twists = self.band.is_some_and(|(.., winding)| winding.families == Families::One);
        let numbers = self.mesh.numbers(self.end, band_twists || self.wall.twists());
        let mut values = vec![0.0; numbers.count];
        let (mut done, mut part, mut before) = (0.0, FIRST_PART, f64::INFINITY);
        while done < 1.0 {
            let next = f64::min(done + part, 1.0);
            let rate = |found: &[f64]| (self.lumen(&numbers, found) - self.lumen(&numbers, &values)) / (next - done);
            let on_branch = |found: &Vec<f64>| (0.0..=LARGEST_GROWTH * before).contains(&rate(found));
            match self.newton(&numbers, &values, pressure * next).filter(on_branch) {
                Some(found) => {
                    before = rate(&found);
                    (values, done) = (found, next);
                    part *= 2.0;
                }
                None if part < LEAST_PART => return Err(NoEquilibrium { last: pressure * done }),
                None => part *= 0.4,
            }
        }
        Ok(Shaped { numbers, values })
    }

    fn newton(&self, numbers: &Numbers, start: &[f64], pressure: f64) -> Option<Vec<f64>> {
        let mut values = start.to_vec();
        for _ in 0..NEWTON_STEPS {
            let (matrix, mut step) = self.assemble(numbers, &values, pressure)?;
            matrix.solve(&mut step)?;
            let change = self.largest_change(numbers, &step);
            let share = f64::min(1.0, LARGEST_CHANGE / change);
            values.iter_mut().zip(&step).for_each(|(value, step)| *value -= share * step);
            if change < TOLERANCE {
                return Some(values);
            }
        }
        None
    }

    fn lumen(&self, numbers: &Numbers, values: &[f64]) -> f64 {
        let along = 0..self.mesh.elements()[1];
        along.map(|j| self.element([0, j], &local(numbers, [0, j], values)).lumen()).sum()
    }

    fn largest_change(&self, numbers: &Numbers, step: &[f64]) -> f64 {
        let change = |at| {
            let values = local(numbers, at, step);
            self.element(at, &values).change(&values)
        };
        self.places().map(change).fold(0.0, f64::max)
    }

    fn places(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [across, along] = self.mesh.elements();
        (0..along).flat_map(move |j| (0..across).map(move |i| [i, j]))
    }

    fn element<'a>(&self, [i, j]: [usize; 2], values: &'a [f64; ALL]) -> Element<'a> {
        let Mesh { radii, places } = &self.mesh;
        Element { inner: radii[i], width: radii[i + 1] - radii[i], height: places[j + 1] - places[j], values }
    }

    /// The matrix and the residual of the equations.
    fn assemble(&self, numbers: &Numbers, values: &[f64], pressure: f64) -> Option<(Band, Vec<f64>)> {
        let mut matrix = Band::new(numbers.count, numbers.reach);
        let mut residual = vec![0.0; numbers.count];
        for at in self.places() {
            let share = self.share(at, &local(numbers, at, values), pressure)?;
            let used = numbers.of_element(at);
            for (i, row) in used.iter().enumerate() {
                let Some(row) = *row else { continue };
                residual[row] += share.first[i];
                for (j, column) in used.iter().enumerate() {
                    if let Some(column) = *column {
                        matrix.add(row, column, share.second[i][j]);
                    }
                }
            }
        }
        Some((matrix, residual))
    }

    fn share(&self, at: [usize; 2], values: &[f64; ALL], pressure: f64) -> Option<Box<Share>> {
        let element = self.element(at, values);
        let mut share = Box::new(Share::NONE);
        element.add_wall(&self.wall, &mut share)?;
        let sheets = self.wall.sheets.iter().map(|(radius, winding)| (*radius, f64::INFINITY, winding));
        let band = self.band.iter().map(|(radius, end, winding)| (*radius, *end, winding));
        for (radius, end, winding) in sheets.chain(band) {
            let is_covered = self.mesh.places[at[1] + 1] <= end * (1.0 + 1e-12);
            let is_at = |place: f64| is_covered && (place - radius).abs() < 1e-9;
            if is_at(self.mesh.radii[at[0] + 1]) {
                element.add_sheet(1.0, winding, &mut share);
            } else if at[0] == 0 && is_at(self.mesh.radii[0]) {
                element.add_sheet(-1.0, winding, &mut share);
            }
        }
        if at[0] == 0 {
            element.add_lumen(pressure, &mut share);
        }
        Some(share)
    }
}

fn local(numbers: &Numbers, element: [usize; 2], values: &[f64]) -> [f64; ALL] {
    numbers.of_element(element).map(|number| number.map_or(0.0, |number| values[number]))
}

impl Shaped {
    /// Displacement of the end along the axis, and its turn about it.
    pub(super) fn end(&self) -> [f64; 2] {
        [self.values[self.numbers.shift], self.numbers.turn.map_or(0.0, |turn| self.values[turn])]
    }

    /// Axial strain, twist rate and hoop strain of the outer surface at the plane of symmetry.
    pub(super) fn middle(&self, mesh: &Mesh) -> [f64; 3] {
        let values = local(&self.numbers, [mesh.radii.len() - 2, 0], &self.values);
        let slopes = quadratics(-1.0).1.map(|slope| slope * 2.0 / (mesh.places[1] - mesh.places[0]));
        let rate = |field: usize| (0..3).map(|k| slopes[k] * values[(3 * k + 2) * FIELDS + field]).sum();
        [rate(2), rate(1), values[2 * FIELDS] / mesh.radii[mesh.radii.len() - 1]]
    }
}
