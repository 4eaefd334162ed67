//! Bytes that wait for the link, in whole frames.

use softlimb_protocol::{DeviceMessage, MAX_FRAME_LEN, encode_frame};

/// Bytes that can wait: eight of the largest frames.
const CAPACITY: usize = 8 * MAX_FRAME_LEN;
const _: () = assert!(2 * CAPACITY <= u16::MAX as usize);

/// Space that stays free for answers when telemetry is queued.
const RESERVE: usize = 2 * MAX_FRAME_LEN;

/// The queue: a ring that is copied in pieces, since every byte of every turn passes it.
#[derive(Clone, Debug)]
pub(crate) struct Outbox {
    ring: [u8; CAPACITY],
    /// Place of the first byte, below the capacity.
    start: u16,
    len: u16,
    seq: u16,
}

impl Outbox {
    pub(crate) const fn new() -> Self {
        Self { ring: [0; CAPACITY], start: 0, len: 0, seq: 0 }
    }

    /// Queues a message; false, and nothing queued, when there is no room. The host repeats a request without answer.
    pub(crate) fn push(&mut self, message: &DeviceMessage) -> bool {
        let mut frame = [0; MAX_FRAME_LEN];
        let encoded = encode_frame(message, self.seq, &mut frame).ok().and_then(|len| frame.get(..len));
        let Some(frame) = encoded else { return false };
        if frame.len() > self.room() {
            return false;
        }
        self.seq = self.seq.wrapping_add(1);
        let end = wrapped(usize::from(self.start) + usize::from(self.len));
        let (to_end, from_start) = frame.split_at(frame.len().min(CAPACITY - end));
        copy(to_end, self.ring.get_mut(end..));
        copy(from_start, Some(&mut self.ring));
        self.len += frame.len() as u16;
        true
    }

    /// Whether there is room for telemetry with enough left for answers.
    pub(crate) fn has_room_for_telemetry(&self) -> bool {
        self.room() >= MAX_FRAME_LEN + RESERVE
    }

    fn room(&self) -> usize {
        CAPACITY - usize::from(self.len)
    }

    /// Moves bytes to the link; returns how many.
    pub(crate) fn drain(&mut self, out: &mut [u8]) -> usize {
        let (start, count) = (usize::from(self.start), out.len().min(usize::from(self.len)));
        let to_end = count.min(CAPACITY - start);
        copy(self.ring.get(start..start + to_end).unwrap_or_default(), Some(out));
        copy(self.ring.get(..count - to_end).unwrap_or_default(), out.get_mut(to_end..));
        self.start = wrapped(start + count) as u16;
        self.len -= count as u16;
        count
    }
}

/// A place in the ring; `place` is less than twice the capacity.
const fn wrapped(place: usize) -> usize {
    if place < CAPACITY { place } else { place - CAPACITY }
}

/// Copies `from` to the beginning of `to`, which is at least as long.
fn copy(from: &[u8], to: Option<&mut [u8]>) {
    if let Some(place) = to.and_then(|to| to.get_mut(..from.len())) {
        place.copy_from_slice(from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softlimb_protocol::{Decoder, DeviceState, HeartbeatReply};

    fn reply(host_time_us: u64) -> DeviceMessage {
        HeartbeatReply { host_time_us, mcu_time_us: 0, state: DeviceState::Idle.into(), free_knots: 0 }.into()
    }

    #[test]
    fn full_box_takes_no_part_of_a_frame_and_loses_none_that_it_took() {
        let mut outbox = Outbox::new();
        let taken = (0..1_000).take_while(|&number| outbox.push(&reply(number))).count();
        assert!(taken > 8 && taken < 1_000, "{taken}");
        assert!(!outbox.has_room_for_telemetry());
        let (mut decoder, mut bytes, mut numbers) = (Decoder::<DeviceMessage>::new(), [0; 7], Vec::new());
        loop {
            let count = outbox.drain(&mut bytes);
            if count == 0 {
                break;
            }
            for frame in bytes[..count].iter().filter_map(|&byte| decoder.push(byte)) {
                numbers.push(frame.unwrap().seq);
            }
        }
        assert_eq!(numbers, (0..taken as u16).collect::<Vec<_>>());
        assert!(outbox.has_room_for_telemetry());
    }

    #[test]
    fn frames_cross_the_end_of_the_ring_whole() {
        let (mut outbox, mut decoder, mut bytes) = (Outbox::new(), Decoder::<DeviceMessage>::new(), [0; 61]);
        let mut seen = 0;
        for number in 0..300 {
            assert!(outbox.push(&reply(number)));
            let count = outbox.drain(&mut bytes);
            for frame in bytes[..count].iter().filter_map(|&byte| decoder.push(byte)) {
                let frame = frame.unwrap();
                assert_eq!((frame.seq, frame.message), (seen as u16, reply(seen)));
                seen += 1;
            }
        }
        assert_eq!(seen, 300, "more than four times around");
    }
}
