//! Bytes that wait for the link, in whole frames.

use heapless::Deque;
use softlimb_protocol::{DeviceMessage, MAX_FRAME_LEN, encode_frame};

/// Bytes that can wait: eight of the largest frames.
const CAPACITY: usize = 8 * MAX_FRAME_LEN;

/// Space that stays free for answers when telemetry is queued.
const RESERVE: usize = 2 * MAX_FRAME_LEN;

/// The queue.
#[derive(Clone, Debug)]
pub(crate) struct Outbox {
    bytes: Deque<u8, CAPACITY>,
    seq: u16,
}

impl Outbox {
    pub(crate) const fn new() -> Self {
        Self { bytes: Deque::new(), seq: 0 }
    }

    /// Queues a message; false, and nothing queued, when there is no room. The host repeats a request without answer.
    pub(crate) fn push(&mut self, message: &DeviceMessage) -> bool {
        let mut frame = [0; MAX_FRAME_LEN];
        let encoded = encode_frame(message, self.seq, &mut frame).ok().and_then(|len| frame.get(..len));
        let Some(frame) = encoded else { return false };
        if frame.len() > CAPACITY - self.bytes.len() {
            return false;
        }
        self.seq = self.seq.wrapping_add(1);
        frame.iter().all(|&byte| self.bytes.push_back(byte).is_ok())
    }

    /// Whether there is room for telemetry with enough left for answers.
    pub(crate) fn has_room_for_telemetry(&self) -> bool {
        CAPACITY - self.bytes.len() >= MAX_FRAME_LEN + RESERVE
    }

    /// Moves bytes to the link; returns how many.
    pub(crate) fn drain(&mut self, out: &mut [u8]) -> usize {
        let mut count = 0;
        for place in out {
            let Some(byte) = self.bytes.pop_front() else { break };
            *place = byte;
            count += 1;
        }
        count
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
}
