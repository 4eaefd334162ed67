//! Arguments from Python.

use fra_model::{Load, Parameter, Target};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::columns::Numbers;
use super::refused::Refusal;
use super::solve::Choice;

/// A copy of the numbers, which other threads cannot change.
pub(crate) fn values(numbers: &Numbers<'_>) -> PyResult<Vec<f64>> {
    Ok(numbers.as_slice()?.to_vec())
}

/// Loads, one a row; or none.
pub(crate) struct Loads(Option<(Vec<f64>, Vec<f64>)>);

impl Loads {
    /// # Errors
    /// Another number of loads than of rows.
    pub(crate) fn new(loads: Option<(Numbers<'_>, Numbers<'_>)>, rows: usize) -> PyResult<Self> {
        let Some((forces, torques)) = loads else { return Ok(Self(None)) };
        if forces.len() != rows || torques.len() != rows {
            return Err(PyValueError::new_err("a load a row, or none"));
        }
        Ok(Self(Some((values(&forces)?, values(&torques)?))))
    }

    pub(crate) fn are_none(&self) -> bool {
        self.0.is_none()
    }

    /// # Errors
    /// A load that is not finite.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let Some((forces, torques)) = &self.0 else { return Ok(()) };
        Refusal::unless_finite("external_force_n", forces)?;
        Refusal::unless_finite("external_torque_nm", torques)
    }

    /// The load of a row.
    pub(crate) fn at(&self, row: usize) -> Load<f64> {
        let loads = self.0.as_ref();
        loads.map_or_else(Load::none, |(forces, torques)| Load { force_n: forces[row], torque_nm: torques[row] })
    }
}

/// The model of a name.
pub(crate) fn choice(model: &str, tolerance: f64) -> PyResult<Choice> {
    match model {
        "auto" => Ok(Choice::Auto(tolerance)),
        "analytic" => Ok(Choice::Analytic),
        "section-fe" => Ok(Choice::SectionFe),
        _ => Err(PyValueError::new_err(format!("model = {model:?} is not allowed: auto, analytic, section-fe"))),
    }
}

/// The kind of target of a name.
pub(crate) fn target(quantity: &str) -> PyResult<fn(f64) -> Target<f64>> {
    match quantity {
        "axial_stretch" => Ok(Target::AxialStretch),
        "outer_radius_m" => Ok(Target::OuterRadius),
        "inner_radius_m" => Ok(Target::InnerRadius),
        "twist_rad" => Ok(Target::Twist),
        "bend_angle_rad" => Ok(Target::BendAngle),
        _ => Err(PyValueError::new_err(format!("{quantity:?} is no deformation"))),
    }
}

/// The input of a name.
pub(crate) fn parameter(name: &str) -> PyResult<Parameter> {
    let found = Parameter::ALL.into_iter().find(|parameter| parameter.name() == name);
    found.ok_or_else(|| PyValueError::new_err(format!("{name:?} is no input")))
}
