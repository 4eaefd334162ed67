//! Errors of the section model.

use fra_model::InvalidParameter;

use softlimb_files::range::OutOfRange;

/// A question that makes no sense. That an equilibrium does not exist is no error but an [`Outcome`](super::Outcome).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SectionError {
    /// A parameter of the actuator that the model cannot accept.
    #[error(transparent)]
    Parameter(#[from] InvalidParameter<f64>),
    /// A parameter of the second winding that the model cannot accept.
    #[error("second winding: {0}")]
    SecondWinding(InvalidParameter<f64>),
    /// An option, a pressure or a load out of range; fields are those of [`Options`](super::Options), [`Mesh`](super::Mesh),
    /// [`Limiter`](super::Limiter) or [`EndLoad`](super::EndLoad), and `pressures_pa` for a pressure.
    #[error(transparent)]
    Option(#[from] OutOfRange),
    /// A polynomial cannot be fitted because there is no bend to fit it to.
    #[error("no bend to calibrate: {reason} at {pressure_pa} Pa")]
    NoBend {
        /// Why.
        reason: &'static str,
        /// Where, gauge Pa.
        pressure_pa: f64,
    },
}
