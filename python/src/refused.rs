//! Values that the model does not accept, with the element they are of.

use std::borrow::Cow;

use fra_model::InvalidParameter;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use softlimb_fea::cross_section::SectionError;

create_exception!(_native, Refused, PyValueError, "Arguments: field, flat index, value, allowed values.");

/// A value that is not accepted.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// Index of the element, in the flat order of what the call goes through.
    pub(crate) index: usize,
    field: Cow<'static, str>,
    value: f64,
    allowed: Cow<'static, str>,
}

impl Refusal {
    /// The error of the model about one element.
    pub(crate) fn new(index: usize, error: InvalidParameter<f64>) -> Self {
        Self { index, field: error.field.into(), value: error.value, allowed: error.allowed.into() }
    }

    /// The error of the model about one segment of a series.
    pub(crate) fn of_segment(index: usize, segment: usize, error: InvalidParameter<f64>) -> Self {
        Self { field: format!("segments[{segment}].{}", error.field).into(), ..Self::new(index, error) }
    }

    /// A series of nothing.
    pub(crate) fn no_segment() -> Self {
        Self { index: 0, field: "segments".into(), value: 0.0, allowed: "one segment or more".into() }
    }

    /// The equilibria of an actuator do not depend on the input of a derivative.
    pub(crate) fn not_an_input(index: usize) -> Self {
        Self { index, field: "of".into(), value: f64::NAN, allowed: "an input of every actuator".into() }
    }

    /// The error of the finite elements about one element.
    pub(crate) fn of_section(index: usize, error: SectionError) -> Self {
        match error {
            SectionError::Parameter(error) | SectionError::SecondWinding(error) => Self::new(index, error),
            SectionError::Option(error) => {
                Self { index, field: error.field.into(), value: error.value, allowed: error.allowed }
            }
            SectionError::NoBend { reason, pressure_pa } => {
                Self { index, field: "pressure_pa".into(), value: pressure_pa, allowed: reason.into() }
            }
        }
    }

    /// `Err` with the first value that is not finite.
    pub(crate) fn unless_finite(field: &'static str, values: &[f64]) -> Result<(), Self> {
        let bad = values.iter().position(|value| !value.is_finite());
        bad.map_or(Ok(()), |index| {
            Err(Self { index, field: field.into(), value: values[index], allowed: "finite".into() })
        })
    }
}

impl From<Refusal> for PyErr {
    fn from(refusal: Refusal) -> Self {
        let Refusal { index, field, value, allowed } = refusal;
        Refused::new_err((field.into_owned(), index, value, allowed.into_owned()))
    }
}
