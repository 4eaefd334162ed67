//! Numbers that are out of their range, for all finite elements.

use std::borrow::Cow;

use fra_model::InvalidParameter;

/// A value that is not accepted, with what is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} = {value} is not allowed: {allowed}")]
pub struct OutOfRange {
    /// Name of the field or argument; its unit is in the name.
    pub field: &'static str,
    /// The value found.
    pub value: f64,
    /// Accepted values.
    pub allowed: Cow<'static, str>,
}

impl From<InvalidParameter<f64>> for OutOfRange {
    fn from(error: InvalidParameter<f64>) -> Self {
        Self { field: error.field, value: error.value, allowed: error.allowed.into() }
    }
}

/// `Err` that names the field unless `accepted`.
pub fn require(
    accepted: bool,
    field: &'static str,
    value: f64,
    allowed: impl Into<Cow<'static, str>>,
) -> Result<(), OutOfRange> {
    if accepted { Ok(()) } else { Err(OutOfRange { field, value, allowed: allowed.into() }) }
}

/// Requires a finite positive value.
pub fn positive(field: &'static str, value: f64) -> Result<(), OutOfRange> {
    require(value.is_finite() && value > 0.0, field, value, "finite and > 0")
}
