//! Errors of bytes, messages and setpoints.

use core::error::Error;
use core::fmt;

/// Why a message could not be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The caller's buffer is shorter than the frame; [`MAX_FRAME_LEN`](crate::MAX_FRAME_LEN) always suffices.
    BufferTooSmall,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BufferTooSmall => f.write_str("the buffer is shorter than the frame"),
        }
    }
}

/// Why a payload of a known type was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PayloadError {
    /// The payload ends before the last field of its message.
    Truncated,
    /// A list announces no elements or more than [`MAX_CHANNELS`](crate::MAX_CHANNELS).
    ListLength {
        /// The announced number of elements.
        count: u8,
    },
}

impl fmt::Display for PayloadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated => f.write_str("the payload ends before its last field"),
            Self::ListLength { count } => write!(f, "a list of {count} elements is not allowed"),
        }
    }
}

/// Why the bytes between two delimiters were rejected. Nothing of a rejected frame is ever used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// A delimiter arrived inside a COBS run.
    Malformed,
    /// More than [`MAX_BODY_LEN`](crate::MAX_BODY_LEN) bytes after COBS decoding.
    Oversize,
    /// Fewer bytes than a header and a checksum.
    TooShort,
    /// The checksum does not match.
    Crc,
    /// The checksum matches, but the type is not one the receiver accepts.
    UnknownType {
        /// The type byte.
        message_type: u8,
    },
    /// The checksum and the type are right, but the payload is not.
    Payload {
        /// The type byte.
        message_type: u8,
        /// Sequence number of the frame.
        seq: u16,
        /// Error of the payload.
        error: PayloadError,
    },
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed => f.write_str("delimiter inside a COBS run"),
            Self::Oversize => f.write_str("frame longer than 254 bytes"),
            Self::TooShort => f.write_str("frame shorter than header and checksum"),
            Self::Crc => f.write_str("checksum mismatch"),
            Self::UnknownType { message_type } => {
                write!(f, "unknown message type {message_type:#04x}")
            }
            Self::Payload { message_type, seq, error } => {
                write!(f, "message {message_type:#04x} number {seq}: {error}")
            }
        }
    }
}

/// A list was built from no elements or from more than [`MAX_CHANNELS`](crate::MAX_CHANNELS).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListLengthError;

impl fmt::Display for ListLengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list holds 1 to {} elements", crate::message::MAX_CHANNELS)
    }
}

/// Why a setpoint has no integer on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetpointError {
    /// The value is NaN or infinite.
    NotFinite,
    /// The value, rounded to the wire unit, does not fit 32 bits.
    OutOfRange,
}

impl fmt::Display for SetpointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the setpoint is not a finite number",
            Self::OutOfRange => "the setpoint does not fit 32 bits in its wire unit",
        })
    }
}

impl Error for EncodeError {}
impl Error for PayloadError {}
impl Error for FrameError {}
impl Error for ListLengthError {}
impl Error for SetpointError {}
