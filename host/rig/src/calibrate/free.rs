//! Bodies alone, without a load.

use std::panic::resume_unwind;
use std::thread;

use fra_model::StateQuantity;
use nalgebra::DMatrix;

use super::body::{NoAnswer, Solver};
use super::problem::{Measured, Model, Refused};
use super::{Body, BodyModel, Branch, CalibrationError, Observation, Property, Unknown, section};

/// Step of an unknown for a derivative by finite elements, over the largest half width that is useful.
const STEP: f64 = 1e-5;

/// Observations of bodies without load.
pub(super) struct Free<'a> {
    pub(super) observations: &'a [Observation],
    /// The model of each body.
    pub(super) models: &'a [BodyModel],
    /// The largest reading, Pa.
    pub(super) most_pa: f64,
}

impl Model for Free<'_> {
    fn measured(&self) -> Vec<Measured> {
        let of = |seen: &Observation| Measured { value: seen.value, accuracy: seen.accuracy };
        self.observations.iter().map(of).collect()
    }

    fn values(&self, bodies: &[Body]) -> Vec<Option<f64>> {
        let mut values = vec![None; self.observations.len()];
        for (index, body) in bodies.iter().enumerate() {
            let rows = self.rows(index);
            for (row, value) in rows.iter().zip(self.deformations(index, body, &rows)) {
                values[*row] = value.ok();
            }
        }
        values
    }

    fn linearized(&self, bodies: &[Body], unknowns: &[Unknown]) -> Result<(Vec<f64>, DMatrix<f64>), Refused> {
        let mut values = vec![0.0; self.observations.len()];
        let mut slopes = DMatrix::zeros(self.observations.len(), unknowns.len());
        for index in 0..bodies.len() {
            let local = self.linearized_body(index, bodies, unknowns);
            for (row, value, of_row) in local.map_err(|(row, why)| self.refused(bodies, row, why))? {
                values[row] = value;
                of_row.into_iter().for_each(|(column, slope)| slopes[(row, column)] = slope);
            }
        }
        Ok((values, slopes))
    }
}

/// Row of an observation, its value, and its derivatives by some of the unknowns.
type LocalRow = (usize, f64, Vec<(usize, f64)>);

impl Free<'_> {
    /// The observations of a body.
    fn rows(&self, index: usize) -> Vec<usize> {
        (0..self.observations.len()).filter(|row| self.observations[*row].body == index).collect()
    }

    /// The deformations of a body in some of its observations.
    fn deformations(&self, index: usize, body: &Body, rows: &[usize]) -> Vec<Result<f64, NoAnswer>> {
        let seen = || rows.iter().map(|row| &self.observations[*row]);
        let all = if self.models[index].is_by_section() {
            section::deformations(body, &seen().collect::<Vec<_>>())
        } else {
            let value = |solver: &Solver<'_>, seen: &Observation| {
                solver.at(seen.reading_pa, seen.branch, seen.quantity).map(|answer| answer.value)
            };
            body.solver().map(|solver| seen().map(|seen| value(&solver, seen)).collect())
        };
        all.unwrap_or_else(|why| vec![Err(why); rows.len()])
    }

    /// The observations of a body with their derivatives, or the row that has no value.
    fn linearized_body(
        &self,
        index: usize,
        bodies: &[Body],
        unknowns: &[Unknown],
    ) -> Result<Vec<LocalRow>, (usize, NoAnswer)> {
        let (body, rows) = (&bodies[index], self.rows(index));
        let own: Vec<(usize, &Unknown)> =
            unknowns.iter().enumerate().filter(|(_, unknown)| unknown.bodies.contains(&index)).collect();
        let Some(first) = rows.first() else { return Ok(Vec::new()) };
        if self.models[index].is_by_section() {
            return self.differences(index, bodies, &own, &rows);
        }
        let solver = body.solver().map_err(|why| (*first, why))?;
        let of_row = |row: usize| {
            let seen = &self.observations[row];
            let answer = solver.at(seen.reading_pa, seen.branch, seen.quantity)?;
            let slopes = own.iter().map(|(column, unknown)| Ok((*column, solver.slope(&answer, unknown.property)?)));
            Ok((row, answer.value, slopes.collect::<Result<_, NoAnswer>>()?))
        };
        rows.iter().map(|row| of_row(*row).map_err(|why| (*row, why))).collect()
    }

    /// The same by finite elements, whose derivatives are differences of solutions.
    fn differences(
        &self,
        index: usize,
        bodies: &[Body],
        own: &[(usize, &Unknown)],
        rows: &[usize],
    ) -> Result<Vec<LocalRow>, (usize, NoAnswer)> {
        let body = &bodies[index];
        let step = |unknown: &Unknown| STEP * unknown.scale(bodies, self.most_pa);
        let moved = own.iter().map(|(_, unknown)| {
            let (property, mut moved) = (unknown.property, body.clone());
            property.place(&mut moved, property.value(body).unwrap_or(0.0) + step(unknown));
            moved
        });
        // Each takes a tenth of a second and more, and none needs another.
        let all: Vec<Body> = std::iter::once(body.clone()).chain(moved).collect();
        let curves: Vec<_> = thread::scope(|scope| {
            let curve = |body| scope.spawn(move || self.deformations(index, body, rows));
            let threads: Vec<_> = all.iter().map(curve).collect();
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
        });
        let value = |curve: usize, at: usize| curves[curve][at].clone().map_err(|why| (rows[at], why));
        let of_row = |(at, row): (usize, &usize)| {
            let here = value(0, at)?;
            let slopes = own
                .iter()
                .enumerate()
                .map(|(curve, (column, unknown))| Ok((*column, (value(curve + 1, at)? - here) / step(unknown))));
            Ok((*row, here, slopes.collect::<Result<_, _>>()?))
        };
        rows.iter().enumerate().map(of_row).collect()
    }

    /// An error of a fit, with the cause where no values reproduce the data because a deformation has the opposite sign.
    pub(super) fn explained(&self, bodies: &[Body], error: CalibrationError) -> CalibrationError {
        if !matches!(error, CalibrationError::NotReproduced { .. }) {
            return error;
        }
        let modelled = self.values(bodies);
        let opposite = (0..self.observations.len()).find_map(|row| self.opposite(bodies, &modelled, row));
        opposite.unwrap_or(error)
    }

    /// The error of an observation if all changes of its kind have the opposite sign of the model's.
    fn opposite(&self, bodies: &[Body], modelled: &[Option<f64>], row: usize) -> Option<CalibrationError> {
        let Observation { body, quantity, reading_pa, .. } = self.observations[row];
        let rest = bodies[body].at_rest(quantity);
        let changes = |row: usize| {
            let seen = &self.observations[row];
            let measured = seen.value - rest;
            // Noise about zero has either sign.
            Some([measured, modelled[row]? - rest]).filter(|_| measured.abs() > seen.accuracy)
        };
        let alike = |row: &usize| (self.observations[*row].body, self.observations[*row].quantity) == (body, quantity);
        let mut of_kind = (0..modelled.len()).filter(alike).filter_map(changes);
        if !of_kind.all(|[measured, model]| measured * model < 0.0) {
            return None;
        }
        let shown = |change: f64| format!("{:.4} {}", change * quantity.display_scale(), quantity.display_unit());
        let [measured, modelled] = changes(row)?.map(|change| shown(change).trim_end().to_owned());
        let (body, quantity) = (bodies[body].name.clone(), quantity.label());
        Some(CalibrationError::OppositeSign { body, quantity, reading_pa, measured, modelled })
    }

    fn refused(&self, bodies: &[Body], row: usize, why: NoAnswer) -> Refused {
        let seen = &self.observations[row];
        let too_soft = matches!(why, NoAnswer::BeyondLimit(_));
        Refused { error: refused(&bodies[seen.body], seen.reading_pa, why), too_soft }
    }
}

/// A body without an answer at a reading.
pub(super) fn refused(body: &Body, reading_pa: f64, why: NoAnswer) -> CalibrationError {
    let no_equilibrium =
        |limit_pa, hint| CalibrationError::NoEquilibrium { body: body.name.clone(), reading_pa, limit_pa, hint };
    match why {
        NoAnswer::Invalid(error) => CalibrationError::Invalid {
            field: error.field,
            value: error.value,
            place: body.name.clone(),
            allowed: error.allowed,
        },
        NoAnswer::BeyondLimit(limit_pa) => {
            no_equilibrium(limit_pa, "check the parameters of the start, or leave these points out")
        }
        NoAnswer::NoDerivative => no_equilibrium(None, "it is at a limit point there; leave these points out"),
    }
}

/// Refuses a loop of which only one branch was measured: its width would be a dead band.
pub(super) fn check_branches(
    bodies: &[Body],
    observations: &[Observation],
    unknowns: &[Unknown],
) -> Result<(), CalibrationError> {
    for unknown in unknowns.iter().filter(|unknown| unknown.property == Property::LoopWidth) {
        let own = || observations.iter().filter(|seen| unknown.bodies.contains(&seen.body));
        let has = |branch| own().any(|seen| seen.branch == branch);
        if !(has(Branch::Loading) && has(Branch::Unloading)) {
            let body = unknown.bodies.first().and_then(|body| bodies.get(*body));
            return Err(CalibrationError::NoSuchProperty {
                body: body.map_or_else(String::new, |body| body.name.clone()),
                property: unknown.property,
                because: "its measurements are of one branch; give those of `loading` and `unloading`",
            });
        }
    }
    Ok(())
}

/// Refuses bodies and observations that are none.
pub(super) fn check(bodies: &[Body], observations: &[Observation]) -> Result<(), CalibrationError> {
    let invalid =
        |field, value, place: String, allowed| Err(CalibrationError::Invalid { field, value, place, allowed });
    for body in bodies {
        if !(body.pressure_gain.is_finite() && body.pressure_gain > 0.0) {
            return invalid("pressure_gain", body.pressure_gain, body.name.clone(), "finite and > 0");
        }
        if !body.seating_pressure_pa.is_finite() {
            return invalid("seating_pressure_pa", body.seating_pressure_pa, body.name.clone(), "finite");
        }
        if !body.loop_width_pa.is_finite() {
            return invalid("loop_width_pa", body.loop_width_pa, body.name.clone(), "finite");
        }
        if !body.pressure_offset_pa.is_finite() {
            return invalid("pressure_offset_pa", body.pressure_offset_pa, body.name.clone(), "finite");
        }
    }
    for (index, seen) in observations.iter().enumerate() {
        let place = || format!("observation {}", index + 1);
        if seen.body >= bodies.len() {
            return invalid("body", seen.body as f64, place(), "an index of the bodies given");
        }
        if seen.quantity == StateQuantity::Pressure {
            return invalid("quantity", seen.value, place(), "a deformation, not a pressure");
        }
        for (field, value) in [("reading_pa", seen.reading_pa), ("value", seen.value)] {
            if !value.is_finite() {
                return invalid(field, value, place(), "finite");
            }
        }
        if !(seen.accuracy.is_finite() && seen.accuracy > 0.0) {
            return invalid("accuracy", seen.accuracy, place(), "finite and > 0");
        }
    }
    Ok(())
}
