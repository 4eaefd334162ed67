//! Target: any bytes at a decoder.

use softlimb_protocol::{Decoder, DeviceMessage, Frame, Heartbeat, HostMessage, Message};

use crate::frame;

/// Feeds bytes to the decoders of both directions.
///
/// # Panics
/// Where a frame is not counted, or where the valid frame behind the bytes is lost.
pub fn bytes(noise: &[u8]) {
    one_direction::<DeviceMessage>(noise);
    let heartbeat = Heartbeat { session: 7, host_time_us: 1 << 40 };
    let (mut decoder, valid) = (one_direction::<HostMessage>(noise), frame::<HostMessage>(9, heartbeat.clone()));
    let last = valid.iter().filter_map(|&byte| decoder.push(byte)).last();
    assert_eq!(last, Some(Ok(Frame { seq: 9, message: heartbeat.into() })), "behind {noise:02x?}");
}

fn one_direction<M: Message>(noise: &[u8]) -> Decoder<M> {
    let mut decoder = Decoder::<M>::new();
    let outcomes: Vec<bool> = noise.iter().filter_map(|&byte| Some(decoder.push(byte)?.is_ok())).collect();
    let accepted = outcomes.iter().filter(|is_ok| **is_ok).count();
    let counters = decoder.counters();
    assert_eq!((counters.accepted as usize, counters.rejected() as usize), (accepted, outcomes.len() - accepted));
    decoder
}
