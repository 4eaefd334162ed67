//! Faults on the link, against the decoder, the device's controller and the host's session.
//!
//! Each target draws faults from a [`Draw`]: seeded random numbers in tests and in the bench, the bytes of a fuzzer in `libfuzzer/`. A
//! target panics where something wrong is applied, or where more than one valid frame is lost behind garbage.

pub mod bytes;
pub mod device;
mod draw;
mod fault;
pub mod host;

pub use draw::Draw;

use softlimb_protocol::{MAX_FRAME_LEN, Message, encode_frame};

/// Faults that a target injects between two looks at its [`Draw`].
pub const ROUND: u64 = 64;

/// The bytes of one frame, both delimiters included.
fn frame<M: Message>(seq: u16, message: impl Into<M>) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME_LEN];
    let len = encode_frame(&message.into(), seq, &mut bytes).expect("a whole-frame buffer is large enough");
    bytes[..len].to_vec()
}
