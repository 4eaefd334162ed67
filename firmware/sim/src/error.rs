//! Why a simulated device could not be built, or an emulated one does not run.

use std::io;
use std::path::PathBuf;

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
    /// More channels than the controller of this device drives.
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

/// Why an emulated processor does not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EmulatorError {
    /// The emulator is not installed.
    #[error(
        "qemu-system-arm is not installed:\n  \
         Debian, Ubuntu: apt-get install qemu-system-arm      Fedora: dnf install qemu-system-arm\n  \
         macOS:          brew install qemu"
    )]
    NotInstalled,
    /// The image cannot be read.
    #[error("cannot read the image {}: {source}; `cargo xtask firmware --board f405` builds it", path.display())]
    NoImage {
        /// The image.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file is no image of the kind that is needed.
    #[error("{} is no such image: {reason}", path.display())]
    PoorImage {
        /// The image.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The emulator ended or stopped to answer.
    #[error("the emulator does not answer any more: {0}")]
    Gone(#[from] io::Error),
    /// The emulator says something else than it must.
    #[error("the emulator answers `{answer}` to `{question}`")]
    Strange {
        /// The question.
        question: String,
        /// The answer.
        answer: String,
    },
}
