//! Frames: `0x00`, COBS(type, sequence, payload, CRC-32C), `0x00`.

mod decoder;
mod frame;

pub use decoder::{Decoder, Frame, LinkCounters};
pub(crate) use frame::Body;
pub use frame::{MAX_BODY_LEN, MAX_FRAME_LEN, MAX_PAYLOAD_LEN, Message, encode_frame};
