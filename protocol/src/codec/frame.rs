//! From a message to the bytes on the wire.

use cobs::try_encode;

use crate::crc::crc32c;
use crate::error::{EncodeError, PayloadError};
use crate::wire::{Reader, Wire, Writer};

/// Type byte and sequence number.
pub(super) const HEADER_LEN: usize = 1 + 2;
/// The checksum.
pub(super) const CRC_LEN: usize = 4;
/// The byte that stands between frames and nowhere else.
pub(super) const DELIMITER: u8 = 0;

/// Most bytes of a frame before COBS, header and checksum included.
///
/// COBS spends one byte per 254: up to this length its overhead is exactly one byte.
pub const MAX_BODY_LEN: usize = 254;

/// Most bytes of a payload.
pub const MAX_PAYLOAD_LEN: usize = MAX_BODY_LEN - HEADER_LEN - CRC_LEN;

/// Most bytes of a frame on the wire: two delimiters, one byte of COBS overhead, the body.
pub const MAX_FRAME_LEN: usize = MAX_BODY_LEN + 3;

/// The messages of one direction.
#[allow(private_bounds, reason = "sealed: the interface table is the only source of messages")]
pub trait Message: Body {
    /// The type byte.
    fn message_type(&self) -> u8;
}

/// Payloads of the messages of one direction.
pub(crate) trait Body: Sized {
    /// Appends the payload.
    fn write_payload(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError>;

    /// Reads a payload of the given type; `None` for a type that this direction does not have.
    fn read_payload(message_type: u8, payload: &[u8]) -> Option<Result<Self, PayloadError>>;
}

/// Writes `message` as one frame, delimiters included, to the front of `out` and returns its length.
///
/// # Errors
/// [`EncodeError::BufferTooSmall`] when `out` is shorter than the frame; its content is then unspecified.
pub fn encode_frame<M: Message>(message: &M, seq: u16, out: &mut [u8]) -> Result<usize, EncodeError> {
    let mut body = [0; MAX_BODY_LEN];
    let writer = &mut Writer::new(&mut body);
    message.message_type().write(writer)?;
    seq.write(writer)?;
    message.write_payload(writer)?;
    crc32c(writer.written()).write(writer)?;
    delimit(writer.written(), out)
}

/// Stuffs `body` and puts delimiters around it.
fn delimit(body: &[u8], out: &mut [u8]) -> Result<usize, EncodeError> {
    let too_small = EncodeError::BufferTooSmall;
    let (first, stuffed) = out.split_first_mut().ok_or(too_small)?;
    let len = try_encode(body, stuffed).map_err(|_| too_small)?;
    let last = stuffed.get_mut(len).ok_or(too_small)?;
    *first = DELIMITER;
    *last = DELIMITER;
    Ok(len + 2)
}

/// Splits a body into type, sequence number, payload and received checksum; `None` when it is too short.
pub(super) fn split_body(body: &[u8]) -> Option<(u8, u16, &[u8], u32)> {
    let (checked, crc) = body.split_last_chunk::<CRC_LEN>()?;
    let (header, payload) = checked.split_first_chunk::<HEADER_LEN>()?;
    let mut reader = Reader::new(header);
    let message_type = u8::read(&mut reader).ok()?;
    let seq = u16::read(&mut reader).ok()?;
    Some((message_type, seq, payload, u32::from_le_bytes(*crc)))
}
