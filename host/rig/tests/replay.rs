//! The bytes of the link and the ticks of a run in its log, and re-runs of the controller on them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use softlimb_protocol::{
    Batch, BootCause, Decoder, DeviceMessage, DeviceState, FaultCode, Frame, HostMessage, LogCondition, LogKind,
    LogRecord, LogRecords, LogState, MAX_FRAME_LEN, Message, SYSTEM_CHANNEL, Telemetry, encode_frame,
};
use softlimb_rig::link::LinkFaults;
use softlimb_rig::record::{Capture, Direction, WireBytes, read_capture};
use softlimb_rig::replay::{Replay, ReplayError, replay};
use softlimb_rig::run::{Mcu, RunFiles, RunOptions, run};
use softlimb_scene::parse;

pub(crate) const ONE_FINGER: &str = r#"
format = 1
name = "minimal"
weight.simulated = false
materials.silicone = { law = "neo-hookean", shear_modulus = "0.2 MPa" }
limb.connector = { length = 0, mass = 0 }
module = [{ name = "a", motion = "bending", actuators = 1, inner_radius = 0.010, outer_radius = 0.014, length = 0.2, material = "silicone" }]
phase = [{ name = "p", duration = 0.4, targets = { a = { pressure = "20 kPa" } }, gripper = "close" }]
"#;

fn ran(folder: &Path) -> RunFiles {
    ran_with(folder, None)
}

fn ran_with(folder: &Path, link_faults: Option<LinkFaults>) -> RunFiles {
    let scene = parse(ONE_FINGER, "minimal.toml").unwrap();
    let options = RunOptions { seed: 3, out: folder.to_owned(), mcu: Mcu::Here, link_faults, faults: Vec::new() };
    run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap()
}

/// The messages of one direction; none is hurt.
fn messages<D: Message>(capture: &Capture, direction: Direction) -> Vec<D> {
    let mut decoder = Decoder::<D>::new();
    let bytes = capture.bytes(direction).flat_map(|(_, bytes)| bytes);
    bytes.filter_map(|&byte| decoder.push(byte)).map(|frame| frame.unwrap().message).collect()
}

#[test]
fn log_holds_every_byte_of_the_link_and_every_tick() {
    let folder = tempfile::tempdir().unwrap();
    let files = ran(folder.path());
    let capture = read_capture(&files.log).unwrap();
    let count = |direction| capture.bytes(direction).map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
    let link = files.run.link;
    assert_eq!((count(Direction::ToDevice), count(Direction::ToHost)), (link.bytes_sent, link.bytes_received));

    let told = messages::<HostMessage>(&capture, Direction::ToDevice);
    assert!(matches!(told.first(), Some(HostMessage::Hello(_))), "{:?}", told.first());
    assert!(told.iter().any(|message| matches!(message, HostMessage::ConfigCommit(_))));
    let answered = messages::<DeviceMessage>(&capture, Direction::ToHost);
    assert!(matches!(answered.first(), Some(DeviceMessage::HelloReply(_))), "{:?}", answered.first());
    assert_eq!((told.len() as u64, answered.len() as u64), (link.frames_sent, link.frames_received));
    assert!(capture.wire.windows(2).all(|pair| pair[0].host_us <= pair[1].host_us));

    assert!(!capture.at_pins && capture.ticks.len() > 2_000, "{}", capture.ticks.len());
    assert!((0..).step_by(1_000).zip(&capture.ticks).all(|(us, tick)| tick.device_us == us && tick.codes.len() == 2));
    assert!(capture.ticks.iter().any(|tick| tick.pulses.iter().any(|pulse| pulse.fill_us > 0)));
    assert!(capture.ticks.iter().any(|tick| tick.supply_open && tick.outputs == 1));
}

/// The capture of a run.
fn captured(link_faults: Option<LinkFaults>) -> Capture {
    let folder = tempfile::tempdir().unwrap();
    read_capture(ran_with(folder.path(), link_faults).log).unwrap()
}

/// The capture of a device that does not show its ticks.
fn of_a_device(capture: &Capture) -> Capture {
    Capture { ticks: Vec::new(), ..capture.clone() }
}

/// Changes the first measurement of a running device later than a time, in its frame; the device's time of it, us.
pub(crate) fn forge(capture: &mut Capture, after_us: u64, change: impl Fn(&mut Telemetry)) -> u64 {
    replace(capture, |message| match message {
        DeviceMessage::Telemetry(telemetry)
            if telemetry.time_us > after_us && telemetry.state == DeviceState::Running =>
        {
            change(telemetry);
            Some(telemetry.time_us)
        }
        _ => None,
    })
}

/// Changes the first message of the device that `change` takes, in its frame; the answer of `change`.
pub(crate) fn replace<R>(capture: &mut Capture, mut change: impl FnMut(&mut DeviceMessage) -> Option<R>) -> R {
    let pieces = capture.wire.iter_mut().filter(|wire| wire.direction == Direction::ToHost);
    let mut bytes: Vec<&mut u8> = pieces.flat_map(|wire| &mut wire.bytes).collect();
    let (mut decoder, mut frame) = (Decoder::<DeviceMessage>::new(), [0; MAX_FRAME_LEN]);
    for end in 0..bytes.len() {
        let Some(Ok(Frame { seq, mut message })) = decoder.push(*bytes[end]) else { continue };
        let length = encode_frame(&message, seq, &mut frame).unwrap();
        let Some(answer) = change(&mut message) else { continue };
        assert_eq!(encode_frame(&message, seq, &mut frame), Ok(length));
        bytes[end + 1 - length..=end].iter_mut().zip(frame).for_each(|(place, byte)| **place = byte);
        return answer;
    }
    panic!("no such message")
}

#[track_caller]
pub(crate) fn differs(replay: &Replay, device_us: u64, at: &str) {
    let difference = replay.difference.as_ref().unwrap_or_else(|| panic!("no difference: {replay:?}"));
    assert_eq!((difference.device_us, difference.at.as_str()), (device_us, at), "{difference:?}");
}

#[test]
fn rerun_gives_every_coil_and_every_message_of_the_log() {
    for link_faults in [None, Some("loss=0.05,flip=0.02,duplicate=0.02".parse().unwrap())] {
        let capture = captured(link_faults);
        let replay = replay(&capture).unwrap();
        assert_eq!(replay.difference, None);
        assert!(replay.is_exact);
        let messages = messages::<DeviceMessage>(&capture, Direction::ToHost).len() as u64;
        assert_eq!((replay.ticks, replay.ticks_compared), (capture.ticks.len() as u64, capture.ticks.len() as u64));
        assert_eq!((replay.messages, replay.messages_missing), (messages, 0));
    }
}

#[test]
fn stored_records_of_the_device_are_passed_over() {
    let mut capture = captured(None);
    let rerun = replay(&capture).unwrap();
    let records = [(LogKind::Boot, BootCause::PowerOn as u8), (LogKind::Fault, FaultCode::OverPressure as u8)];
    let records = records.map(|(kind, code)| LogRecord {
        number: 7,
        start: 3,
        kind: kind.into(),
        code,
        channel: SYSTEM_CHANNEL,
        detail: 0,
        time_us: 5,
    });
    let mut batch = Batch::default();
    records.iter().for_each(|record| batch.push(record).unwrap());
    let state = LogState { condition: LogCondition::Kept.into(), next: 9, until: 9, unstored: 0, records: 2 };
    let stored: [DeviceMessage; 2] = [LogRecords { records: batch }.into(), state.into()];
    // After the first bytes of the device, which are its answer to the Hello.
    let place = capture.wire.iter().position(|wire| wire.direction == Direction::ToHost).unwrap() + 1;
    let mut bytes = Vec::new();
    for (seq, message) in (0..).zip(&stored) {
        let mut frame = [0; MAX_FRAME_LEN];
        let length = encode_frame(message, seq, &mut frame).unwrap();
        bytes.extend_from_slice(&frame[..length]);
    }
    let wire = WireBytes { bytes, ..capture.wire[place - 1].clone() };
    capture.wire.insert(place, wire);
    assert_eq!(messages::<DeviceMessage>(&capture, Direction::ToHost)[2..4], stored);
    assert_eq!(replay(&capture).unwrap(), rerun);
}

#[test]
fn first_difference_is_told_with_its_time_and_place() {
    let whole = captured(None);
    // One converter code off by one: the pressure of that tick is reported if it is a tick of a report, and remembered if not.
    let mut capture = whole.clone();
    let pulse =
        |capture: &Capture| capture.ticks.iter().position(|tick| tick.pulses.iter().any(|pulse| pulse.fill_us > 0));
    let index = pulse(&capture).unwrap();
    capture.ticks[index].codes[0] += 40;
    assert!(replay(&capture).unwrap().difference.unwrap().device_us >= capture.ticks[index].device_us);
    // A coil time.
    let mut capture = whole.clone();
    capture.ticks[index].pulses[0].fill_us -= 1;
    differs(&replay(&capture).unwrap(), capture.ticks[index].device_us, "channel 0, coils");
    // A message of the device.
    let mut capture = whole.clone();
    let time_us = forge(&mut capture, 0, |telemetry| telemetry.channels[0].duty ^= 1);
    differs(&replay(&capture).unwrap(), time_us, "channel 0, duty, 1/127");
    let mut capture = whole;
    let time_us = forge(&mut capture, 0, |telemetry| telemetry.supply_10pa += 1);
    differs(&replay(&capture).unwrap(), time_us, "supply, 10 Pa");
}

#[test]
fn without_ticks_what_follows_from_the_frames_of_the_host_is_compared() {
    let whole = captured(None);
    let device = of_a_device(&whole);
    let rerun = replay(&device).unwrap();
    assert_eq!(rerun.difference, None);
    assert!(!rerun.is_exact && rerun.ticks_compared == 0 && rerun.messages > 50, "{rerun:?}");
    // What depends on the sensors is not compared, but what the knots and the state decide is.
    let mut capture = device.clone();
    forge(&mut capture, 0, |telemetry| telemetry.channels[0].duty ^= 1);
    assert_eq!(replay(&capture).unwrap().difference, None);
    let mut capture = device.clone();
    let start_us = rerun.start_us.unwrap();
    let time_us = forge(&mut capture, start_us + 100_000, |telemetry| telemetry.channels[0].reference_10pa += 1);
    differs(&replay(&capture).unwrap(), time_us, "channel 0, reference, 10 Pa");
    let mut capture = device;
    let time_us = forge(&mut capture, 0, |telemetry| telemetry.free_knots += 1);
    differs(&replay(&capture).unwrap(), time_us, "free places for knots");
}

#[test]
fn log_without_a_beginning_is_refused() {
    assert_eq!(replay(&Capture::default()), Err(ReplayError::NoWire));
    let mut capture = captured(None);
    let hello = capture.wire.iter().position(|wire| wire.direction == Direction::ToHost).unwrap();
    capture.wire.drain(..=hello);
    let later = replay(&capture);
    assert!(matches!(later, Err(ReplayError::NoHello)), "{later:?}");
}
