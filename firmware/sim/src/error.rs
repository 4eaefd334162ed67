//! Why a simulated device could not be built.

use softlimb_plant::PlantError;

/// A setting that is not accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// A value outside its range.
    #[error("{field} = {value} is not allowed: {low} to {high}")]
    OutOfRange {
        /// Path of the field in [`SimSettings`](crate::SimSettings).
        field: &'static str,
        /// The value found.
        value: f64,
        /// Lowest value accepted.
        low: f64,
        /// Highest value accepted.
        high: f64,
    },
    /// More channels than the controller drives.
    #[error("the plant has {channels} channels, the controller drives at most {max}")]
    TooManyChannels {
        /// Channels of the plant.
        channels: usize,
        /// Channels of the controller.
        max: usize,
    },
    /// The plant refuses its settings.
    #[error(transparent)]
    Plant(#[from] PlantError),
}
