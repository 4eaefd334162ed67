//! Analytic model of fiber-reinforced actuators (FRA).
#![no_std]

mod parameters;
mod real;
mod solution;

pub use parameters::{ActuatorParameters, Families, Fiber, InvalidParameter, Material, Motion, Placement};
pub use real::Real;
pub use solution::{Load, Solution, State, Status, Target};

/// One actuator, checked and ready to solve. (Solver under construction: signatures are final.)
#[derive(Clone, Copy, Debug)]
pub struct Actuator<T> {
    parameters: ActuatorParameters<T>,
}

impl<T: Real> Actuator<T> {
    /// Checks the parameters and prepares the solver.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the field.
    pub fn new(parameters: &ActuatorParameters<T>) -> Result<Self, InvalidParameter<T>> {
        parameters.check()?;
        Ok(Self { parameters: *parameters })
    }

    /// The parameters it was built from.
    pub fn parameters(&self) -> &ActuatorParameters<T> {
        &self.parameters
    }
}
