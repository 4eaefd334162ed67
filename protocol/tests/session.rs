//! Reliable messages over a link that loses, doubles and delays: each is applied once, in order.

use std::collections::VecDeque;

use crate::common::Random;
use softlimb_protocol::*;

const POLICY: RetryPolicy = RetryPolicy { timeout_us: 1_000, attempts_max: 3 };

fn command(session: u16, code: CommandCode, time_us: u64) -> HostMessage {
    Command { session, code: code.into(), time_us }.into()
}

fn hello(session: u16) -> HostMessage {
    Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session }.into()
}

fn ack(message: &HostMessage, seq: u16, result: ResultCode) -> Ack {
    Ack {
        ref_type: message.message_type(),
        ref_seq: seq,
        result: result.into(),
        detail: 0,
        free_knots: 0,
        mcu_time_us: 0,
    }
}

fn hello_reply(session: u16) -> DeviceMessage {
    HelloReply {
        protocol_version: PROTOCOL_VERSION,
        schema_hash: SCHEMA_HASH,
        session,
        firmware_major: 0,
        firmware_minor: 1,
        firmware_patch: 0,
        boot_cause: BootCause::PowerOn.into(),
        boot_detail: 0,
        state: DeviceState::Idle.into(),
        channels_max: 27,
        knots_capacity: 64,
        tick_us: 1000,
        config_hash: 0,
        mcu_time_us: 0,
    }
    .into()
}

#[test]
fn sender_repeats_the_same_bytes_then_gives_up() {
    let mut sender = ReliableSender::new(POLICY);
    assert_eq!(sender.poll(0), SenderStep::Idle);
    let message = command(7, CommandCode::Hold, 0);
    assert_eq!(sender.send(&message, 100), Ok(0));
    assert_eq!(sender.send(&message, 100), Err(SendError::Busy));
    let expected = crate::common::encode(&message, 0);
    for attempt in 0..3 {
        let now_us = 100 + attempt * 1_000;
        assert_eq!(sender.poll(now_us), SenderStep::Transmit(&expected));
        assert_eq!(sender.poll(now_us), SenderStep::WaitUntil(now_us + 1_000));
        assert_eq!(sender.poll(now_us + 999), SenderStep::WaitUntil(now_us + 1_000));
    }
    assert_eq!(sender.poll(3_100), SenderStep::GaveUp { message_type: 0x07, seq: 0 });
    assert_eq!(sender.poll(3_100), SenderStep::Idle);
    assert_eq!(sender.retransmissions(), 2);
    assert_eq!(sender.send(&message, 4_000), Ok(1), "a dropped number is never used again");
}

#[test]
fn only_the_matching_ack_ends_the_wait() {
    let mut sender = ReliableSender::new(POLICY);
    let message = command(7, CommandCode::Hold, 0);
    sender.send(&message, 0).unwrap();
    assert!(!sender.on_message(&ack(&message, 1, ResultCode::Ok).into()));
    assert!(!sender.on_message(&ack(&hello(7), 0, ResultCode::Ok).into()));
    assert!(!sender.on_message(&hello_reply(7)));
    assert!(sender.is_busy());
    assert!(sender.on_message(&ack(&message, 0, ResultCode::WrongState).into()));
    assert!(!sender.is_busy());
}

#[test]
fn hello_waits_for_its_reply_or_a_refusal() {
    let mut sender = ReliableSender::new(POLICY);
    sender.send(&hello(7), 0).unwrap();
    assert!(!sender.on_message(&hello_reply(8)));
    assert!(!sender.on_message(&ack(&hello(7), 0, ResultCode::Ok).into()));
    assert!(sender.on_message(&hello_reply(7)));
    sender.send(&hello(7), 0).unwrap();
    assert!(sender.on_message(&ack(&hello(7), 1, ResultCode::SchemaMismatch).into()));
}

#[test]
fn unreliable_messages_are_refused() {
    let heartbeat = Heartbeat { session: 7, host_time_us: 0 }.into();
    assert_eq!(ReliableSender::new(POLICY).send(&heartbeat, 0), Err(SendError::NotReliable));
}

#[test]
fn repeated_stale_and_new_are_told_apart() {
    let mut dedup = SeqDedup::new();
    let message = command(7, CommandCode::Hold, 0);
    assert_eq!(dedup.classify(5, &message), Arrival::New);
    let answer = ack(&message, 5, ResultCode::WrongState);
    dedup.record(&message, &answer);
    assert_eq!(dedup.classify(5, &message), Arrival::Repeated(answer));
    assert_eq!(dedup.classify(4, &message), Arrival::Stale);
    assert_eq!(dedup.classify(5_u16.wrapping_sub(0x7FFF), &message), Arrival::Stale);
    assert_eq!(dedup.classify(5_u16.wrapping_sub(0x8000), &message), Arrival::New);
    assert_eq!(dedup.classify(6, &message), Arrival::New);
    assert_eq!(dedup.classify(5, &command(8, CommandCode::Hold, 0)), Arrival::New, "another session");
    assert_eq!(dedup.classify(2, &hello(7)), Arrival::New, "a Hello is never stale");
    let heartbeat = Heartbeat { session: 7, host_time_us: 0 }.into();
    assert_eq!(dedup.classify(5, &heartbeat), Arrival::New, "not reliable");
}

#[test]
fn answers_to_unreliable_messages_are_not_remembered() {
    let mut dedup = SeqDedup::new();
    let message = command(7, CommandCode::Hold, 0);
    let answer = ack(&message, 5, ResultCode::Ok);
    dedup.record(&message, &answer);
    let setpoint = Setpoint {
        session: 7,
        index: 0,
        time_us: 0,
        outputs: Outputs::default(),
        values: List::from_slice(&[0]).unwrap(),
    }
    .into();
    dedup.record(&setpoint, &ack(&setpoint, 900, ResultCode::Ok));
    assert_eq!(dedup.classify(5, &message), Arrival::Repeated(answer));
}

#[test]
fn sequence_wraps() {
    let mut dedup = SeqDedup::new();
    let message = command(7, CommandCode::Hold, 0);
    dedup.record(&message, &ack(&message, 65_535, ResultCode::Ok));
    assert_eq!(dedup.classify(0, &message), Arrival::New);
    dedup.record(&message, &ack(&message, 0, ResultCode::Ok));
    assert_eq!(dedup.classify(65_535, &message), Arrival::Stale);
}

/// One direction of a bad line: loses 30 % of the bytes' frames, doubles 20 %, delivers some late and out of order.
struct BadLine {
    random: Random,
    frames: VecDeque<(u64, Vec<u8>)>,
}

impl BadLine {
    fn new(seed: u64) -> Self {
        Self { random: Random(seed), frames: VecDeque::new() }
    }

    fn write(&mut self, now_us: u64, bytes: &[u8]) {
        let copies = [0, 0, 0, 1, 1, 1, 1, 1, 2, 2][self.random.below(10)];
        for _ in 0..copies {
            self.frames.push_back((now_us + self.random.below(4_000) as u64, bytes.to_vec()));
        }
    }

    fn read(&mut self, now_us: u64) -> Vec<u8> {
        let (due, late): (Vec<_>, Vec<_>) = self.frames.drain(..).partition(|(time_us, _)| *time_us <= now_us);
        self.frames.extend(late);
        due.into_iter().flat_map(|(_, bytes)| bytes).collect()
    }
}

/// A device that applies commands and writes down their times.
#[derive(Default)]
struct Device {
    decoder: Decoder<HostMessage>,
    dedup: SeqDedup,
    applied: Vec<u64>,
}

impl Device {
    fn receive(&mut self, bytes: &[u8]) -> Vec<Ack> {
        bytes.iter().filter_map(|&byte| self.decoder.push(byte)?.ok().and_then(|frame| self.answer(&frame))).collect()
    }

    fn answer(&mut self, frame: &Frame<HostMessage>) -> Option<Ack> {
        match self.dedup.classify(frame.seq, &frame.message) {
            Arrival::Repeated(ack) => return Some(ack),
            Arrival::Stale => return None,
            Arrival::New => {}
        }
        if let HostMessage::Command(command) = &frame.message {
            self.applied.push(command.time_us);
        }
        let ack = ack(&frame.message, frame.seq, ResultCode::Ok);
        self.dedup.record(&frame.message, &ack);
        Some(ack)
    }
}

#[test]
fn bad_line_applies_every_command_once_and_in_order() {
    const COMMANDS: u64 = 2_000;
    for seed in 0..5 {
        let (mut down, mut up) = (BadLine::new(seed), BadLine::new(seed + 100));
        let mut sender = ReliableSender::new(RetryPolicy { timeout_us: 3_000, attempts_max: 1_000 });
        let (mut device, mut replies) = (Device::default(), Decoder::<DeviceMessage>::new());
        let (mut now_us, mut sent) = (0, 0);
        while sent < COMMANDS || sender.is_busy() {
            now_us += 250;
            assert!(now_us < 1_000_000_000, "seed {seed}: {sent} commands sent");
            if !sender.is_busy() {
                sender.send(&command(7, CommandCode::Hold, sent), now_us).unwrap();
                sent += 1;
            }
            if let SenderStep::Transmit(bytes) = sender.poll(now_us) {
                down.write(now_us, bytes);
            }
            for ack in device.receive(&down.read(now_us)) {
                up.write(now_us, &crate::common::encode(&DeviceMessage::from(ack), 0));
            }
            for frame in up.read(now_us).iter().filter_map(|&byte| replies.push(byte)) {
                sender.on_message(&frame.unwrap().message);
            }
        }
        assert!(sender.retransmissions() > 500, "the line must be bad: {}", sender.retransmissions());
        assert_eq!(device.applied, (0..COMMANDS).collect::<Vec<_>>(), "seed {seed}");
    }
}
