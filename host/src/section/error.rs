//! What the section model does not accept.

use fra_model::InvalidParameter;

/// A question that makes no sense. That an equilibrium does not exist is no error but an [`Outcome`](super::Outcome).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SectionError {
    /// A parameter of the actuator that the model cannot accept.
    #[error(transparent)]
    Parameter(#[from] InvalidParameter<f64>),
    /// An option, a pressure or a load out of range.
    #[error("{field} = {value} is not allowed: {allowed}")]
    Option {
        /// Name of the field, as in [`Options`](super::Options), [`Mesh`](super::Mesh), [`Limiter`](super::Limiter) or
        /// [`EndLoad`](super::EndLoad); `pressures_pa` for a pressure.
        field: &'static str,
        /// The value found.
        value: f64,
        /// What is accepted.
        allowed: &'static str,
    },
    /// A polynomial cannot be fitted because there is no bend to fit it to.
    #[error("no bend to calibrate: {reason} at {pressure_pa} Pa")]
    NoBend {
        /// Why.
        reason: &'static str,
        /// Where, gauge Pa.
        pressure_pa: f64,
    },
}

/// `Err` that names the field unless `accepted`.
pub(super) fn require(
    accepted: bool,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), SectionError> {
    if accepted { Ok(()) } else { Err(SectionError::Option { field, value, allowed }) }
}
