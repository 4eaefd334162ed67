//! Why a plant could not be built.

use fra_model::InvalidParameter;

/// A setting the plant cannot accept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlantError {
    /// A value outside its range.
    #[error("{field} = {value} is not allowed: {allowed}")]
    OutOfRange {
        /// Path of the field in [`PlantSettings`](crate::PlantSettings).
        field: String,
        /// The value found.
        value: f64,
        /// Accepted values.
        allowed: String,
    },
    /// The model refuses the actuator of a channel.
    #[error("channels[{channel}].actuator: {source}")]
    Actuator {
        /// The channel.
        channel: usize,
        /// Error of the model.
        source: InvalidParameter<f64>,
    },
    /// The model finds no rising branch of volume over pressure for the true actuator.
    #[error("channels[{channel}].actuator has no usable equilibrium at {pressure_pa} Pa gauge")]
    NoEquilibrium {
        /// The channel.
        channel: usize,
        /// The gauge pressure at which it failed, Pa.
        pressure_pa: f64,
    },
    /// A fault of the pump of a plant that has a regulator.
    #[error("the supply is a regulator: it has no pump that could be weak")]
    NoPump,
    /// A channel that the plant does not have.
    #[error("channel {channel} does not exist: the plant has {channels}")]
    NoSuchChannel {
        /// The requested channel.
        channel: usize,
        /// Number of channels.
        channels: usize,
    },
}
