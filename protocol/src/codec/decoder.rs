//! From bytes in any chunking to messages.

use core::marker::PhantomData;

use super::frame::{CRC_LEN, DELIMITER, MAX_BODY_LEN, Message, split_body};
use crate::crc::crc32c;
use crate::error::FrameError;

/// One accepted frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame<M> {
    /// Sequence number that the sender gave it.
    pub seq: u16,
    /// The message.
    pub message: M,
}

/// Counts of a decoder; each saturates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkCounters {
    /// Accepted frames.
    pub accepted: u32,
    /// [`FrameError::Malformed`].
    pub malformed: u32,
    /// [`FrameError::Oversize`].
    pub oversize: u32,
    /// [`FrameError::TooShort`].
    pub too_short: u32,
    /// [`FrameError::Crc`].
    pub crc: u32,
    /// [`FrameError::UnknownType`].
    pub unknown_type: u32,
    /// [`FrameError::Payload`].
    pub payload: u32,
}

impl LinkCounters {
    /// All rejected frames.
    #[must_use]
    pub fn rejected(&self) -> u32 {
        [self.malformed, self.oversize, self.too_short, self.crc, self.unknown_type, self.payload]
            .into_iter()
            .fold(0, u32::saturating_add)
    }

    fn count<M>(&mut self, outcome: &Result<Frame<M>, FrameError>) {
        let counter = match outcome {
            Ok(_) => &mut self.accepted,
            Err(FrameError::Malformed) => &mut self.malformed,
            Err(FrameError::Oversize) => &mut self.oversize,
            Err(FrameError::TooShort) => &mut self.too_short,
            Err(FrameError::Crc) => &mut self.crc,
            Err(FrameError::UnknownType { .. }) => &mut self.unknown_type,
            Err(FrameError::Payload { .. }) => &mut self.payload,
        };
        *counter = counter.saturating_add(1);
    }
}

/// The length byte of a piece without a zero behind it.
const FULL_LENGTH: u8 = 0xFF;

/// More bytes than a body has.
const TOO_MANY: usize = MAX_BODY_LEN + 1;

/// Eats bytes one by one and yields the messages of one direction.
///
/// Any bytes may precede: the frame after the next delimiter is decoded as by a new decoder.
#[derive(Clone, Debug)]
pub struct Decoder<M> {
    /// Bytes to come in the COBS piece in progress; `None` between two frames.
    left: Option<u8>,
    /// A zero stood behind the piece in progress, unless the frame ends with it.
    ends_in_zero: bool,
    body: [u8; MAX_BODY_LEN],
    /// Decoded bytes of the frame in progress; `TOO_MANY` once they exceed the body.
    len: usize,
    counters: LinkCounters,
    direction: PhantomData<fn() -> M>,
}

impl<M> Decoder<M> {
    /// A decoder between two frames.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            left: None,
            ends_in_zero: false,
            body: [0; MAX_BODY_LEN],
            len: 0,
            counters: LinkCounters {
                accepted: 0,
                malformed: 0,
                oversize: 0,
                too_short: 0,
                crc: 0,
                unknown_type: 0,
                payload: 0,
            },
            direction: PhantomData,
        }
    }

    /// Counts of accepted and rejected frames so far.
    #[must_use]
    pub fn counters(&self) -> LinkCounters {
        self.counters
    }

    /// Stores one decoded byte.
    fn store(&mut self, byte: u8) {
        match self.body.get_mut(self.len) {
            Some(place) => {
                *place = byte;
                self.len += 1;
            }
            None => self.len = TOO_MANY,
        }
    }
}

impl<M: Message> Decoder<M> {
    /// Eats one byte. At the delimiter that ends a frame, yields the frame or why it was rejected.
    /// Delimiters without anything between them are idle line and yield nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<M>, FrameError>> {
        let outcome = match (self.left, byte) {
            (None, DELIMITER) => return None,
            (Some(0), DELIMITER) => self.finish(),
            (Some(_), DELIMITER) if self.len == TOO_MANY => Err(FrameError::Oversize),
            (Some(_), DELIMITER) => Err(FrameError::Malformed),
            (Some(left @ 1..), _) => {
                self.left = Some(left - 1);
                self.store(byte);
                return None;
            }
            // The length of a piece, which tells the end of the one before.
            (left, length) => {
                if left.is_some() && self.ends_in_zero {
                    self.store(0);
                }
                self.left = Some(length - 1);
                self.ends_in_zero = length < FULL_LENGTH;
                return None;
            }
        };
        (self.left, self.len) = (None, 0);
        self.counters.count(&outcome);
        Some(outcome)
    }

    /// Checks and reads the collected body.
    fn finish(&self) -> Result<Frame<M>, FrameError> {
        let len = self.len;
        let body = self.body.get(..len).ok_or(FrameError::Oversize)?;
        let (message_type, seq, payload, received) = split_body(body).ok_or(FrameError::TooShort)?;
        let checked = body.get(..len - CRC_LEN).ok_or(FrameError::TooShort)?;
        if crc32c(checked) != received {
            return Err(FrameError::Crc);
        }
        // A message is large: no step in between moves it.
        match M::read_payload(message_type, payload) {
            Some(Ok(message)) => Ok(Frame { seq, message }),
            Some(Err(error)) => Err(FrameError::Payload { message_type, seq, error }),
            None => Err(FrameError::UnknownType { message_type }),
        }
    }
}

impl<M> Default for Decoder<M> {
    fn default() -> Self {
        Self::new()
    }
}
