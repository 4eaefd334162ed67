//! The unknowns of a fit, and the model of the measurements that they are fitted to.

use nalgebra::{DMatrix, DVector};

use super::descent::Local;
use super::{Body, CalibrationError, Unknown};

/// Harder walls that a fit tries where the start has no answer, as multiples of its moduli.
const HARDER: [f64; 5] = [1.3, 1.7, 2.5, 4.0, 8.0];

/// A measured value with its accuracy.
pub(super) struct Measured {
    pub(super) value: f64,
    pub(super) accuracy: f64,
}

/// Why a model has no value.
pub(super) struct Refused {
    pub(super) error: CalibrationError,
    /// Whether harder walls may help.
    pub(super) too_soft: bool,
}

/// Measurements as functions of the bodies.
pub(super) trait Model {
    /// The measurements.
    fn measured(&self) -> Vec<Measured>;

    /// What the model makes of each of them; `None` where it has no value.
    fn values(&self, bodies: &[Body]) -> Vec<Option<f64>>;

    /// The same with the derivatives, a column for each unknown, in SI units.
    fn linearized(&self, bodies: &[Body], unknowns: &[Unknown]) -> Result<(Vec<f64>, DMatrix<f64>), Refused>;
}

/// A model in scaled unknowns and residuals.
pub(super) struct Problem<'a, M> {
    pub(super) model: &'a M,
    pub(super) measured: &'a [Measured],
    pub(super) bodies: &'a [Body],
    pub(super) unknowns: &'a [Unknown],
    /// Unit of each scaled unknown.
    pub(super) tolerances: &'a [f64],
}

impl<M: Model> Problem<'_, M> {
    /// The bodies with scaled values of the unknowns.
    pub(super) fn placed(&self, place: &DVector<f64>) -> Vec<Body> {
        let mut bodies = self.bodies.to_vec();
        for ((unknown, value), unit) in self.unknowns.iter().zip(place).zip(self.tolerances) {
            unknown.place(&mut bodies, value * unit);
        }
        bodies
    }

    pub(super) fn local(&self, place: &DVector<f64>) -> Result<Local, Refused> {
        let (values, slopes) = self.model.linearized(&self.placed(place), self.unknowns)?;
        let of_row = |(value, seen): (&f64, &Measured)| (value - seen.value) / seen.accuracy;
        let residuals = DVector::from_iterator(values.len(), values.iter().zip(self.measured).map(of_row));
        let scaled =
            |row: usize, column: usize| slopes[(row, column)] * self.tolerances[column] / self.measured[row].accuracy;
        Ok(Local { residuals, jacobian: DMatrix::from_fn(slopes.nrows(), slopes.ncols(), scaled) })
    }

    /// A place from which every measurement has a value: the start, or the start with harder walls.
    pub(super) fn solvable(&self, start: DVector<f64>) -> Result<DVector<f64>, CalibrationError> {
        let Err(refused) = self.local(&start) else { return Ok(start) };
        let harder = |factor: &f64| {
            let mut harder = start.clone();
            for (value, unknown) in harder.iter_mut().zip(self.unknowns) {
                if unknown.property.is_of_material() {
                    *value *= factor;
                }
            }
            self.local(&harder).is_ok().then_some(harder)
        };
        HARDER.iter().filter(|_| refused.too_soft).find_map(harder).ok_or(refused.error)
    }
}
