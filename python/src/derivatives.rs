//! Exact derivatives of equilibria by one input.

use fra_model::{Actuator, NoDerivative, Parameter, Status, Target};

use super::answers::{FEW, Table};
use super::arguments::Loads;
use super::refused::Refusal;
use super::solve::{code, numbers};

/// Code of an equilibrium at which the derivative is infinite.
const NO_DERIVATIVE: i8 = 3;

/// The quantity kept while the input changes.
#[derive(Clone, Copy)]
pub(crate) enum Fixed {
    /// The gauge pressure.
    Pressure,
    /// A deformation.
    Target(fn(f64) -> Target<f64>),
}

/// Derivatives by one input, each at an equilibrium given by its pressure or by a deformation.
pub(crate) struct SensitivityQuery<'a> {
    pub(crate) of: Parameter,
    pub(crate) fixed: Fixed,
    /// Pressures, Pa, or deformations.
    pub(crate) values: &'a [f64],
    pub(crate) loads: &'a Loads,
}

impl SensitivityQuery<'_> {
    /// The derivatives of the state's numbers.
    pub(crate) fn solve(&self, actuators: &[Actuator<f64>]) -> Result<Table<1, 8>, Refusal> {
        Table::filled(self.values.len(), self.values.len(), FEW, |piece| {
            for row in 0..piece.rows() {
                let i = piece.from + row;
                let (status, count, derivatives) = self.one(&actuators[i % actuators.len()], i)?;
                piece.set(row, [status], count, derivatives);
            }
            Ok(())
        })
    }

    fn one(&self, actuator: &Actuator<f64>, i: usize) -> Result<(i8, u32, [f64; 8]), Refusal> {
        let (value, load) = (self.values[i], self.loads.at(i));
        let solution = match self.fixed {
            Fixed::Pressure => actuator.forward(value, &load),
            Fixed::Target(target) => actuator.inverse(target(value), &load),
        };
        let solution = solution.map_err(|error| Refusal::new(i, error))?;
        if solution.status != Status::Solved {
            return Ok((code(solution.status), solution.iterations, [f64::NAN; 8]));
        }
        let derivative = match self.fixed {
            Fixed::Pressure => actuator.sensitivity(&solution.state, &load, self.of),
            Fixed::Target(target) => actuator.inverse_sensitivity(&solution.state, &load, target(value), self.of),
        };
        match derivative {
            Ok(derivative) => Ok((code(Status::Solved), solution.iterations, numbers(&derivative))),
            Err(NoDerivative::Invalid(error)) => Err(Refusal::new(i, error)),
            Err(NoDerivative::NotAnInput(_)) => Err(Refusal::not_an_input(i)),
            Err(NoDerivative::AtLimit | NoDerivative::Stationary) => {
                Ok((NO_DERIVATIVE, solution.iterations, [f64::NAN; 8]))
            }
            // The solution does not balance to the accuracy of the derivative: no number would be right.
            Err(NoDerivative::NotAnEquilibrium) => Ok((code(Status::NotConverged), solution.iterations, [f64::NAN; 8])),
        }
    }
}
