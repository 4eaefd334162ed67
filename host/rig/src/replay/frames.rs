//! Frames in a stream of bytes, with their own bytes and the time of their end.

use softlimb_protocol::{Decoder, Message};

use crate::record::{Capture, Direction};

/// A valid frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Framed<M> {
    /// When its last byte was sent or arrived, by the host's clock, us.
    pub(super) host_us: u64,
    pub(super) seq: u16,
    pub(super) message: M,
    /// Its bytes, both delimiters included.
    pub(super) bytes: Vec<u8>,
}

/// The valid frames of one direction in order. Bytes between them change nothing at their receiver.
pub(super) fn framed<M: Message>(capture: &Capture, direction: Direction) -> Vec<Framed<M>> {
    let (mut frames, mut splitter) = (Vec::new(), Splitter::default());
    for (host_us, bytes) in capture.bytes(direction) {
        splitter.take(bytes, |seq, message, bytes| frames.push(Framed { host_us, seq, message, bytes }));
    }
    frames
}

/// Cuts a stream at its delimiters.
#[derive(Debug, Default)]
pub(super) struct Splitter(Vec<u8>);

impl Splitter {
    /// Takes bytes in any chunking and gives each valid frame to `on_frame`.
    pub(super) fn take<M: Message>(&mut self, bytes: &[u8], mut on_frame: impl FnMut(u16, M, Vec<u8>)) {
        for &byte in bytes {
            if byte != 0 {
                self.0.push(byte);
                continue;
            }
            let body = std::mem::take(&mut self.0);
            let frame = [&[0], body.as_slice(), &[0]].concat();
            let mut decoder = Decoder::<M>::new();
            if let Some(Ok(valid)) = frame.iter().find_map(|&byte| decoder.push(byte)) {
                on_frame(valid.seq, valid.message, frame);
            }
        }
    }
}
