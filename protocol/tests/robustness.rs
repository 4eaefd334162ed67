//! Bytes that no sender meant: nothing panics, nothing wrong is accepted, the next good frame is.

use crate::common::{Random, config, decode_all, device_message, encode, host_message, samples};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use softlimb_protocol::*;

/// Corrupted frames.
const FRAMES: u32 = 200_000;

proptest! {
    #![proptest_config(config())]

    #[test]
    fn noise_never_panics_and_every_frame_is_counted(bytes in vec(any::<u8>(), 0..2000)) {
        let mut decoder = Decoder::<HostMessage>::new();
        let outcomes: Vec<_> = bytes.iter().filter_map(|&byte| decoder.push(byte)).collect();
        let counters = decoder.counters();
        let accepted = outcomes.iter().filter(|outcome| outcome.is_ok()).count();
        prop_assert_eq!(counters.accepted as usize, accepted);
        prop_assert_eq!(counters.rejected() as usize, outcomes.len() - accepted);
    }

    /// Bodies with a right checksum reach the payload readers, which noise never does.
    #[test]
    fn any_payload_under_a_right_checksum_never_panics(message_type: u8, payload in vec(any::<u8>(), 0..=247)) {
        let wire = frame_of(message_type, &payload);
        prop_assert_eq!(decode_all::<HostMessage>(&wire).len(), 1);
        prop_assert_eq!(decode_all::<DeviceMessage>(&wire).len(), 1);
    }

    #[test]
    fn longer_payload_is_read_without_its_tail(message in host_message(), tail in vec(any::<u8>(), 1..100)) {
        let (message_type, mut payload) = taken_apart(&encode(&message, 1));
        payload.extend(tail);
        prop_assert_eq!(decode_all(&frame_of(message_type, &payload)), [Ok(Frame { seq: 1, message })]);
    }

    #[test]
    fn shorter_payload_is_rejected(message in device_message(), cut in 1_usize..200) {
        let (message_type, payload) = taken_apart(&encode(&message, 1));
        let short = &payload[..payload.len().saturating_sub(cut)];
        let error = PayloadError::Truncated;
        let expected = FrameError::Payload { message_type, seq: 1, error };
        prop_assert_eq!(decode_all::<DeviceMessage>(&frame_of(message_type, short)), [Err(expected)]);
    }

    #[test]
    fn frame_after_noise_and_a_delimiter_is_accepted(
        noise in vec(any::<u8>(), 0..1500),
        message in host_message(),
        seq: u16,
    ) {
        let mut wire = noise;
        wire.extend(encode(&message, seq));
        let outcomes = decode_all(&wire);
        prop_assert_eq!(outcomes.last(), Some(&Ok(Frame { seq, message })));
    }

    #[test]
    fn cut_frame_costs_only_itself(first in host_message(), second in host_message(), cut in 2_usize..300) {
        let mut wire = encode(&first, 1);
        wire.truncate(cut.min(wire.len() - 2));
        wire.extend(encode(&second, 2));
        let outcomes = decode_all(&wire);
        prop_assert_eq!(outcomes.len(), 2);
        prop_assert!(outcomes[0].is_err());
        prop_assert_eq!(&outcomes[1], &Ok(Frame { seq: 2, message: second }));
    }
}

/// A frame around any payload, number 1, by the rules of SPEC.md.
fn frame_of(message_type: u8, payload: &[u8]) -> Vec<u8> {
    let mut body = vec![message_type, 1, 0];
    body.extend(payload);
    body.extend(crc32c(&body).to_le_bytes());
    let mut wire = vec![0];
    wire.extend(stuffed(&body));
    wire.push(0);
    wire
}

fn stuffed(body: &[u8]) -> Vec<u8> {
    let mut out = vec![0; cobs::max_encoding_length(body.len())];
    let len = cobs::encode(body, &mut out);
    out.truncate(len);
    out
}

/// Type and payload of a good frame.
fn taken_apart(wire: &[u8]) -> (u8, Vec<u8>) {
    let mut body = vec![0; wire.len()];
    let len = cobs::decode(&wire[1..], &mut body).unwrap().frame_size();
    (body[0], body[3..len - 4].to_vec())
}

/// The ways a byte stream goes wrong, each seen on serial lines.
fn corrupt(wire: &mut Vec<u8>, random: &mut Random) {
    let place = random.below(wire.len());
    match random.below(7) {
        0 => (0..=random.below(4)).for_each(|_| {
            let place = random.below(wire.len());
            wire[place] ^= 1 << random.below(8);
        }),
        1 => wire.iter_mut().skip(place).take(2 + random.below(7)).for_each(|byte| *byte = random.next() as u8),
        2 => drop(wire.remove(place)),
        3 => wire.insert(place, random.next() as u8),
        4 => wire.insert(place, 0),
        5 => wire.truncate(place),
        _ => {
            let other = random.below(wire.len());
            wire.swap(place, other);
        }
    }
}

#[test]
fn corrupted_frames_are_never_accepted() {
    let mut random = Random(2026);
    let mut runner = TestRunner::deterministic();
    let strategy = host_message();
    let (mut rejected, mut unharmed) = (0, 0);
    for case in 0..samples(FRAMES) {
        // A frame with neighbours, so that a lost delimiter joins two bodies.
        let message = strategy.new_tree(&mut runner).unwrap().current();
        let mut wire = encode(&message, case as u16);
        let following = encode(&message, case as u16);
        corrupt(&mut wire, &mut random);
        wire.extend(&following[usize::from(random.below(2) == 0)..]);
        for outcome in decode_all::<HostMessage>(&wire) {
            match outcome {
                Ok(frame) => {
                    assert_eq!((frame.seq, &frame.message), (case as u16, &message), "case {case}");
                    unharmed += 1;
                }
                Err(_) => rejected += 1,
            }
        }
    }
    println!("{} corrupted frames: {rejected} rejected, {unharmed} accepted, all unharmed copies", samples(FRAMES));
    assert!(4 * rejected > 3 * samples(FRAMES), "the corruption must reach the decoder: {rejected}");
}

#[test]
fn examples_of_the_cobs_paper() {
    // Cheshire and Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Trans. Networking 7(2), 1999: its example
    // packet, the start of an IP header. Then the edges of the rule.
    let packet = [0x45, 0, 0, 0x2C, 0x4C, 0x79, 0, 0, 0x40, 0x06, 0x4F, 0x37];
    let paper = [0x02, 0x45, 0x01, 0x04, 0x2C, 0x4C, 0x79, 0x01, 0x05, 0x40, 0x06, 0x4F, 0x37];
    assert_eq!(stuffed(&packet), paper);
    assert_eq!(stuffed(&[]), [0x01]);
    assert_eq!(stuffed(&[0]), [0x01, 0x01]);
    assert_eq!(stuffed(&[0x11, 0x22, 0, 0x33]), [0x03, 0x11, 0x22, 0x02, 0x33]);
    let full = [0xAB; 254];
    assert_eq!(stuffed(&full)[0], 0xFF);
    assert_eq!(stuffed(&full)[1..], full);
}

#[test]
fn largest_body_is_accepted_and_one_byte_more_is_not() {
    let (message_type, mut payload) =
        taken_apart(&encode(&HostMessage::from(Heartbeat { session: 1, host_time_us: 2 }), 1));
    payload.resize(MAX_PAYLOAD_LEN, 0xEE);
    assert!(decode_all::<HostMessage>(&frame_of(message_type, &payload))[0].is_ok());
    payload.push(0xEE);
    assert_eq!(decode_all::<HostMessage>(&frame_of(message_type, &payload)), [Err(FrameError::Oversize)]);
}
