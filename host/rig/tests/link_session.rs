//! The session alone, against scripted devices: no simulation behind it.

use crate::link_common::SESSION;
use softlimb_protocol::*;
use softlimb_rig::link::{Answer, Event, LinkError, PortErrors, Session, StreamOptions, Transport, stream};

const HELLO: Hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION };

fn session() -> Session {
    Session::new(SESSION, RetryPolicy { timeout_us: 50_000, attempts_max: 3 }, 25_000, 1)
}

fn frame(seq: u16, message: impl Into<DeviceMessage>) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME_LEN];
    let len = encode_frame(&message.into(), seq, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

fn decoded(bytes: &[u8]) -> Vec<Frame<HostMessage>> {
    let mut decoder = Decoder::new();
    bytes.iter().filter_map(|&byte| decoder.push(byte)).map(Result::unwrap).collect()
}

fn reply(protocol_version: u16, schema_hash: u32) -> HelloReply {
    HelloReply {
        protocol_version,
        schema_hash,
        session: SESSION,
        firmware_major: 3,
        firmware_minor: 1,
        firmware_patch: 4,
        boot_cause: BootCause::PowerOn.into(),
        boot_detail: 0,
        state: DeviceState::Idle.into(),
        channels_max: 9,
        knots_capacity: 64,
        tick_us: 1_000,
        config_hash: 0,
        mcu_time_us: 77,
    }
}

fn transmitted(session: &mut Session, now_us: u64) -> (u64, Vec<Frame<HostMessage>>) {
    let mut bytes = Vec::new();
    let due_us = session.transmit(now_us, &mut bytes).unwrap();
    (due_us, decoded(&bytes))
}

#[test]
fn hello_is_repeated_until_answered_and_heartbeats_begin_then() {
    let mut session = session();
    assert_eq!(transmitted(&mut session, 0), (u64::MAX, vec![]), "nothing to say yet");
    session.request(1_000, &HELLO.into()).unwrap();
    assert_eq!(session.request(1_000, &HELLO.into()), Err(SendError::Busy));
    for now_us in [1_000, 51_000] {
        let (due_us, frames) = transmitted(&mut session, now_us);
        assert_eq!((due_us, frames), (now_us + 50_000, vec![Frame { seq: 0, message: HELLO.into() }]));
    }
    session.receive(60_000, &frame(0, reply(PROTOCOL_VERSION, SCHEMA_HASH))).unwrap();
    let Some(Answer::Hello(answer)) = session.take_answer() else { panic!("no answer") };
    assert_eq!((answer.firmware_major, session.state()), (3, Some(DeviceState::Idle)));
    assert_eq!(session.take_answer(), None, "once");
    let (due_us, frames) = transmitted(&mut session, 60_000);
    let heartbeat = Heartbeat { session: SESSION, host_time_us: 60_000 };
    assert_eq!((due_us, &frames[0].message), (85_000, &heartbeat.into()));
    assert_eq!(session.statistics().messages_repeated, 1);
    assert_eq!(session.statistics().frames_sent, 3);
}

#[test]
fn silent_device_is_given_up() {
    let mut session = session();
    session.request(0, &HELLO.into()).unwrap();
    for now_us in [0, 50_000, 100_000] {
        assert_eq!(transmitted(&mut session, now_us).1.len(), 1);
    }
    let error = session.transmit(150_000, &mut Vec::new()).unwrap_err();
    assert!(matches!(error, LinkError::NoAnswer { message: "Hello" }), "{error}");
    assert!(!session.is_busy());
}

#[test]
fn heartbeats_tell_the_clock_and_the_round_trip() {
    let mut session = session();
    session.request(0, &HELLO.into()).unwrap();
    transmitted(&mut session, 0);
    session.receive(1_000, &frame(0, reply(PROTOCOL_VERSION, SCHEMA_HASH))).unwrap();
    assert_eq!(session.clock(), None);
    let beat = |host_time_us, mcu_time_us| HeartbeatReply {
        host_time_us,
        mcu_time_us,
        state: DeviceState::Ready.into(),
        free_knots: 64,
    };
    session.receive(12_000, &frame(1, beat(10_000, 5_011_000))).unwrap();
    let clock = session.clock().unwrap();
    assert_eq!((clock.device_us(11_000), clock.host_us(5_021_000)), (5_011_000, 21_000));
    // From another host's clock, ahead of ours: no round trip.
    session.receive(13_000, &frame(2, beat(99_000_000, 5_012_000))).unwrap();
    assert_eq!(session.clock(), Some(clock));
    let round_trip = session.statistics().round_trip;
    assert_eq!(
        (round_trip.count, round_trip.min_us, round_trip.max_us, round_trip.mean_us()),
        (1, 2_000, 2_000, 2_000)
    );
    let events: Vec<_> = std::iter::from_fn(|| session.next_event()).collect();
    assert_eq!(events, [Event::State(DeviceState::Idle), Event::State(DeviceState::Ready)]);
    assert_eq!(session.silence_us(20_000), 7_000);
}

#[test]
fn damaged_frames_are_counted_and_nothing_else() {
    let mut session = session();
    session.request(0, &HELLO.into()).unwrap();
    let mut bytes = frame(0, reply(PROTOCOL_VERSION, SCHEMA_HASH));
    bytes[8] ^= 0x10;
    session.receive(1_000, &bytes).unwrap();
    assert!(session.is_busy());
    assert_eq!(session.statistics().received.rejected(), 1);
}

/// A port behind which every Hello gets the same reply.
struct Firmware {
    reply: HelloReply,
    now_us: u64,
    answers: Vec<u8>,
    heard: Vec<HostMessage>,
}

impl Transport for Firmware {
    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        for frame in decoded(bytes) {
            self.heard.push(frame.message);
            self.answers.extend(self::frame(0, self.reply.clone()));
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> std::io::Result<()> {
        into.append(&mut self.answers);
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        if self.answers.is_empty() {
            self.now_us = self.now_us.max(deadline_us);
        }
    }
}

#[test]
fn foreign_schema_or_version_ends_the_session_after_the_hello() {
    for reply in [reply(PROTOCOL_VERSION, SCHEMA_HASH ^ 1), reply(PROTOCOL_VERSION + 1, SCHEMA_HASH)] {
        let wrong = reply.schema_hash;
        let mut firmware = Firmware { reply, now_us: 0, answers: vec![], heard: vec![] };
        let (configuration, knots) = (crate::link_common::configuration(1), crate::link_common::knots(1, 1.0));
        let options = StreamOptions::new(SESSION);
        let error = stream(&mut firmware, &configuration, &knots, &options, |_, _| {}).unwrap_err();
        assert!(matches!(error, LinkError::Incompatible { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains("firmware 3.1.4") && text.contains(&format!("{wrong:08x}")), "{text}");
        assert_eq!(firmware.heard, [HELLO.into()], "nothing else is safe");
    }
}

#[test]
fn more_channels_than_the_device_has_are_refused_before_the_upload() {
    let reply = HelloReply { channels_max: 2, ..reply(PROTOCOL_VERSION, SCHEMA_HASH) };
    let mut firmware = Firmware { reply, now_us: 0, answers: vec![], heard: vec![] };
    let (configuration, knots) = (crate::link_common::configuration(3), crate::link_common::knots(3, 1.0));
    let error = stream(&mut firmware, &configuration, &knots, &StreamOptions::new(SESSION), |_, _| {}).unwrap_err();
    assert!(matches!(error, LinkError::ChannelCount { count: 3, max: 2 }), "{error}");
    assert_eq!(firmware.heard.len(), 1);
}

#[test]
fn knots_of_the_wrong_form_are_refused_before_anything_is_sent() {
    let mut firmware = Firmware { reply: reply(0, 0), now_us: 0, answers: vec![], heard: vec![] };
    let mut knots = crate::link_common::knots(2, 1.0);
    knots[7].values.pop();
    let error =
        stream(&mut firmware, &crate::link_common::configuration(2), &knots, &StreamOptions::new(SESSION), |_, _| {});
    assert_eq!(error.unwrap_err().to_string(), "setpoint 7 has 1 values for 2 channels");
    assert!(firmware.heard.is_empty());
}

#[test]
fn errors_of_the_port_are_the_latest_that_the_device_told() {
    let mut session = session();
    assert_eq!(session.statistics().port_errors, None);
    for overrun in [4, 9] {
        let told = LinkErrors { overrun, framing: 1, noise: 2, parity: 3, queue_full: 5 };
        session.receive(0, &frame(0, told)).unwrap();
        let expected = PortErrors { overrun, framing: 1, noise: 2, parity: 3, queue_full: 5 };
        assert_eq!(session.statistics().port_errors, Some(expected));
    }
}
