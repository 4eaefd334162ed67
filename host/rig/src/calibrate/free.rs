//! Bodies alone, without a load.

use fra_model::StateQuantity;
use nalgebra::DMatrix;

use super::body::{Answer, NoAnswer};
use super::problem::{Measured, Model, Refused};
use super::{Body, CalibrationError, Observation, Unknown};

/// Observations of bodies without load.
pub(super) struct Free<'a> {
    pub(super) observations: &'a [Observation],
}

impl Model for Free<'_> {
    fn measured(&self) -> Vec<Measured> {
        let of = |seen: &Observation| Measured { value: seen.value, accuracy: seen.accuracy };
        self.observations.iter().map(of).collect()
    }

    fn values(&self, bodies: &[Body]) -> Vec<Option<f64>> {
        let modelled = |seen: &Observation| -> Result<Answer, NoAnswer> {
            bodies[seen.body].solver()?.at(seen.reading_pa, seen.quantity)
        };
        self.observations.iter().map(|seen| modelled(seen).ok().map(|answer| answer.value)).collect()
    }

    fn linearized(&self, bodies: &[Body], unknowns: &[Unknown]) -> Result<(Vec<f64>, DMatrix<f64>), Refused> {
        let mut solvers = Vec::with_capacity(bodies.len());
        for (index, body) in bodies.iter().enumerate() {
            let first = self.observations.iter().position(|seen| seen.body == index).unwrap_or(0);
            solvers.push(body.solver().map_err(|why| self.refused(bodies, first, why))?);
        }
        let mut values = Vec::with_capacity(self.observations.len());
        let mut slopes = DMatrix::zeros(self.observations.len(), unknowns.len());
        for (row, seen) in self.observations.iter().enumerate() {
            let solver = &solvers[seen.body];
            let refused = |why| self.refused(bodies, row, why);
            let answer = solver.at(seen.reading_pa, seen.quantity).map_err(refused)?;
            for (column, unknown) in unknowns.iter().enumerate() {
                if unknown.bodies.contains(&seen.body) {
                    slopes[(row, column)] = solver.slope(&answer, unknown.property).map_err(refused)?;
                }
            }
            values.push(answer.value);
        }
        Ok((values, slopes))
    }
}

impl Free<'_> {
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
