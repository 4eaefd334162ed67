//! From the wire's configuration to the one the controller runs on: checked on arrival, swapped as a whole.

mod channel;
mod staging;
mod system;
mod tables;

pub use channel::{ChannelConfig, Source};
pub use staging::{StagedConfig, StagingError};
pub use system::SystemConfig;

use heapless::Vec;
use softlimb_protocol::MAX_CHANNELS;

/// Active configuration of the controller. All of it was checked; nothing is checked again.
#[derive(Clone, Debug)]
pub struct ActiveConfig<const N: usize = MAX_CHANNELS> {
    /// Configuration that all channels share.
    pub system: SystemConfig,
    /// The channels, `1..=N`.
    pub channels: Vec<ChannelConfig, N>,
    /// CRC-32C that names this configuration.
    pub hash: u32,
}

/// A field that the device does not accept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// The value is not finite or out of its range.
    OutOfRange {
        /// Number of the field in its message.
        field: u8,
    },
    /// The code is none that this version knows.
    UnknownCode {
        /// Number of the field in its message.
        field: u8,
    },
}

impl ConfigError {
    /// Number of the field in its message, as the protocol counts them.
    pub fn field(&self) -> u8 {
        match *self {
            Self::OutOfRange { field } | Self::UnknownCode { field } => field,
        }
    }
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::OutOfRange { field } => write!(f, "field {field} is out of range"),
            Self::UnknownCode { field } => write!(f, "field {field} holds an unknown code"),
        }
    }
}

impl core::error::Error for ConfigError {}

/// Number of a field of a message, found by the compiler: no image holds its name.
macro_rules! number {
    ($Message:ident, $field:literal) => {
        const {
            assert!($Message::field_number($field).is_some(), "no such field");
            match $Message::field_number($field) {
                Some(number) => number as u8,
                None => 0,
            }
        }
    };
}
pub(crate) use number;

/// The value, if it lies in the range; NaN and infinities lie in none.
fn within<T: PartialOrd>(field: u8, value: T, range: core::ops::RangeInclusive<T>) -> Result<T, ConfigError> {
    if range.contains(&value) { Ok(value) } else { Err(ConfigError::OutOfRange { field }) }
}

/// The member behind a code.
fn known<E: softlimb_protocol::CodeSet>(field: u8, code: softlimb_protocol::Code<E>) -> Result<E, ConfigError> {
    code.known().ok_or(ConfigError::UnknownCode { field })
}
