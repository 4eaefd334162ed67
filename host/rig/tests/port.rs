//! Real ports: sockets and pseudo-terminals of this computer, with the simulated device at their other end.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use softlimb_protocol::{
    Batch, Command, CommandCode, Decoder, DeviceMessage, DeviceState, Hello, HostMessage, MAX_FRAME_LEN, Outputs,
    PROTOCOL_VERSION, ResultCode, SCHEMA_HASH, Tick, Ticks, encode_frame,
};
use softlimb_rig::link::port::{
    Address, ClientPort, Leave, Port, PortAddress, PortError, Served, serve, session_number,
};
use softlimb_rig::link::{
    Direct, Ending, Event, LinkError, SampleRequest, StreamOptions, Transport, identify, listen, stream,
};

use softlimb_rig::record::{Capture, read_capture};
use softlimb_rig::replay::replay;
use softlimb_rig::run::{record_behind, run_behind};

use super::link_common::{Told, configuration, device, knots, settings};
use super::replay::{ONE_FINGER, differs, forge, replace};

fn address(text: &str) -> PortAddress {
    match text.parse() {
        Ok(Address::Port(port)) => port,
        other => panic!("{text}: {other:?}"),
    }
}

/// Waits for bytes for at most 2 s.
fn received(port: &mut Port, count: usize) -> std::io::Result<Vec<u8>> {
    let (mut bytes, deadline_us) = (Vec::new(), port.now_us() + 2_000_000);
    while bytes.len() < count && port.now_us() < deadline_us {
        port.wait_until(deadline_us);
        port.receive(&mut bytes)?;
    }
    Ok(bytes)
}

#[test]
fn bytes_go_both_ways_unchanged_and_the_other_end_s_leave_is_told() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let text = format!("tcp:{}", listener.local_addr().unwrap());
    let all: Vec<u8> = (0..=255).collect();
    let sent = all.clone();
    let echo = thread::spawn(move || {
        let mut client = listener.accept().unwrap().0;
        let mut bytes = [0; 256];
        client.read_exact(&mut bytes).unwrap();
        client.write_all(&bytes).unwrap();
    });
    let mut port = Port::open(&address(&text)).unwrap();
    port.send(&sent).unwrap();
    assert_eq!(received(&mut port, 256).unwrap(), all);
    echo.join().unwrap();
    for _ in 0..2 {
        let error = received(&mut port, 1).unwrap_err().to_string();
        assert!(error.starts_with(&format!("{text} is gone: unplugged")), "{error}");
    }
}

#[test]
fn wait_ends_at_its_deadline_without_bytes_and_the_clock_is_that_of_the_computer() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut port = Port::open(&address(&format!("tcp:{}", listener.local_addr().unwrap()))).unwrap();
    let (began, clock_us) = (std::time::Instant::now(), port.now_us());
    let deadline_us = clock_us + 30_000;
    while port.now_us() < deadline_us {
        port.wait_until(deadline_us);
    }
    let wall_us = began.elapsed().as_micros() as u64;
    assert!(wall_us >= 30_000 && (port.now_us() - clock_us).abs_diff(wall_us) < 5_000, "{wall_us} us");
}

#[test]
fn port_that_cannot_be_opened_is_named_with_the_reason() {
    let error = Port::open(&address("/dev/no-such-port")).unwrap_err();
    assert!(matches!(error, PortError::Serial { .. }));
    let message = error.to_string();
    assert!(message.contains("/dev/no-such-port") && message.contains("softlimb device list"), "{message}");
    let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let message = Port::open(&address(&format!("tcp:{closed}"))).unwrap_err().to_string();
    assert!(message.contains(&format!("cannot connect to tcp:{closed}")), "{message}");
}

/// Ends the server, also when the client panics.
struct Stopping<'a>(&'a AtomicBool);

impl Drop for Stopping<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Serves a device with one channel until `client` has done its work at its address; the news of the device.
fn served<T>(mut port: ClientPort, client: impl FnOnce(&str) -> T) -> (T, Vec<Served>) {
    let text = port.address().unwrap();
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let server = scope.spawn(|| {
            let mut news = Vec::new();
            serve(&mut device(&settings(1)), &mut port, &stop, |_, told| news.push(told)).unwrap();
            news
        });
        let stopping = Stopping(&stop);
        let done = client(&text);
        drop(stopping);
        (done, server.join().unwrap())
    })
}

/// Runs 0.4 s of setpoints on the device at an address.
fn run_at(text: &str) -> (Result<Ending, LinkError>, Told) {
    let mut port = Port::open(&address(text)).unwrap();
    let options = StreamOptions { occupied_max_us: 1_000_000, ..StreamOptions::new(session_number()) };
    let mut told = Told::default();
    let ended = stream(&mut port, &configuration(1), &knots(1, 0.4), &options, |_, event| told.take(event));
    (ended.map(|summary| summary.ending), told)
}

/// Both ends in real time over one kind of port, twice: the second host finds the device that the first one left.
fn two_hosts_run_one_after_the_other(port: ClientPort) -> Vec<Served> {
    let (clocks, news) = served(port, |text| {
        [(); 2].map(|()| {
            let (ended, told) = run_at(text);
            assert_eq!(ended.unwrap(), Ending::Completed);
            assert!(told.running().count() >= 30, "{}", told.running().count());
            told.start_us
        })
    });
    assert!(clocks[1] > clocks[0] + 400_000, "the device's clock goes on: {clocks:?}");
    let running = news.iter().filter(|told| matches!(told, Served::State(state) if *state == DeviceState::Running));
    assert_eq!(running.count(), 2, "{news:?}");
    news
}

#[test]
fn two_hosts_run_one_after_the_other_over_tcp() {
    let news = two_hosts_run_one_after_the_other(ClientPort::tcp("127.0.0.1:0").unwrap());
    let count = |wanted: fn(&Served) -> bool| news.iter().filter(|told| wanted(told)).count();
    assert_eq!(count(|told| matches!(told, Served::Connected(_))), 2, "{news:?}");
    assert!(count(|told| matches!(told, Served::Left { why: Leave::Closed, .. })) >= 1, "{news:?}");
}

/// The device's answers to one frame, apart from its reports: those within 50 ms of the first. On a busy computer that one may take 5 s.
fn answers(port: &mut Port, seq: u16, message: &HostMessage) -> Vec<DeviceMessage> {
    let mut frame = [0; MAX_FRAME_LEN];
    let len = encode_frame(message, seq, &mut frame).unwrap();
    port.send(&frame[..len]).unwrap();
    let is_report = |message: &DeviceMessage| matches!(message, DeviceMessage::Telemetry(_) | DeviceMessage::Fault(_));
    let (mut decoder, mut answers, mut end_us) = (Decoder::new(), Vec::new(), port.now_us() + 5_000_000);
    while port.now_us() < end_us {
        let mut bytes = Vec::new();
        port.wait_until(end_us);
        port.receive(&mut bytes).unwrap();
        let is_first = answers.is_empty();
        let messages = bytes.iter().filter_map(|&byte| Some(decoder.push(byte)?.ok()?.message));
        answers.extend(messages.filter(|message| !is_report(message)));
        if is_first && !answers.is_empty() {
            end_us = port.now_us() + 50_000;
        }
    }
    answers
}

fn command(session: u16, code: CommandCode) -> HostMessage {
    Command { session, code: code.into(), time_us: 0 }.into()
}

/// Waits until the device behind a port reports a state, by listening alone.
fn wait_for(port: &mut Port, state: DeviceState) {
    listen(port, 3_000_000, &AtomicBool::new(false), |event| {
        let Event::Telemetry { message, .. } = event else { return ControlFlow::Continue(()) };
        if message.state == state { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
    .unwrap();
}

#[test]
fn second_client_looks_until_the_first_has_left_and_commands_then() {
    let knots = knots(1, 1.6);
    // A first host that a busy computer pauses for less is not lost.
    let mut patient = configuration(1);
    patient.system.link_timeout_us = 500_000;
    let (_, news) = served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        let mut second = Port::open(&address(text)).unwrap();
        thread::scope(|scope| {
            let first = scope.spawn(|| {
                let mut port = Port::open(&address(text)).unwrap();
                let options = StreamOptions::new(7);
                let ended = stream(&mut port, &patient, &knots, &options, |_, _| {});
                assert_eq!(ended.unwrap().ending, Ending::Completed);
            });
            wait_for(&mut second, DeviceState::Running);
            let options = StreamOptions { occupied_max_us: 0, ..StreamOptions::new(8) };
            let device = identify(&mut second, &options).unwrap();
            assert!(device.is_occupied && device.channels_max == 27 && device.config_hash.is_some(), "{device:?}");
            // Neither its own session nor the number of the first one gives it a say.
            for (seq, session) in [(1, 8), (2, 7)] {
                for code in [CommandCode::Vent, CommandCode::Hold, CommandCode::Flush] {
                    let told = answers(&mut second, seq, &command(session, code));
                    let [DeviceMessage::Ack(ack)] = &told[..] else { panic!("{told:?}") };
                    assert_eq!((ack.ref_seq, ack.result.known()), (seq, Some(ResultCode::WrongSession)));
                }
            }
            let error = Direct::open(&mut second, &options, &mut |_, _| {}).err().map(|error| error.to_string());
            assert_eq!(error.as_deref(), Some("another program controls the device"));
            first.join().unwrap();
        });
        // The device notices the silence of the first after `link_timeout_us`.
        let options = StreamOptions { occupied_max_us: 2_000_000, ..StreamOptions::new(8) };
        let mut on_event = |_: &mut Port, _| {};
        let mut hand = Direct::open(&mut second, &options, &mut on_event).unwrap();
        hand.set_outputs(Outputs::GRIPPER).unwrap();
    });
    let count = |wanted: fn(&Served) -> bool| news.iter().filter(|told| wanted(told)).count();
    assert_eq!(count(|told| matches!(told, Served::Connected(_))), 2, "{news:?}");
    assert_eq!(count(|told| matches!(told, Served::Commands(_))), 2, "{news:?}");
}

#[test]
fn emergency_stop_of_a_client_that_looks_is_obeyed() {
    served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        let mut second = Port::open(&address(text)).unwrap();
        thread::scope(|scope| {
            let first = scope.spawn(|| run_at(text).0);
            wait_for(&mut second, DeviceState::Running);
            let told = answers(&mut second, 1, &command(0, CommandCode::EmergencyStop));
            assert!(matches!(&told[..], [DeviceMessage::Ack(ack)] if ack.result == ResultCode::Ok), "{told:?}");
            let error = first.join().unwrap().unwrap_err().to_string();
            assert!(error.contains("emergency stop"), "{error}");
        });
    });
}

#[test]
fn client_that_died_without_closing_blocks_nobody() {
    served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        // The client commands, then neither reads nor writes, and keeps its connection open.
        let mut dead = Port::open(&address(text)).unwrap();
        let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: 9 }.into();
        assert_eq!(answers(&mut dead, 0, &hello).len(), 2);
        let (ended, told) = run_at(text);
        assert_eq!(ended.unwrap(), Ending::Completed);
        assert!(told.running().count() >= 30);
        drop(dead);
    });
}

#[cfg(unix)]
#[test]
fn two_hosts_run_one_after_the_other_over_a_pseudo_terminal() {
    two_hosts_run_one_after_the_other(ClientPort::terminal().unwrap());
}

#[test]
fn second_run_on_a_device_is_run_again_from_its_start_on() {
    let scene = softlimb_scene::parse(ONE_FINGER, "minimal.toml").unwrap();
    let (captures, _) = served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        [(); 2].map(|()| {
            let folder = tempfile::tempdir().unwrap();
            let cancel = AtomicBool::new(false);
            let limb = softlimb_limb::Limb::new(&scene).unwrap();
            let plan = softlimb_motion::plan(&scene, &limb).unwrap();
            let files =
                run_behind(&scene, (limb, plan), (&address(text), None), None, folder.path(), &cancel, |_| ()).unwrap();
            read_capture(files.log).unwrap()
        })
    });
    let [first, mut second] = captures;
    let (whole, rerun) = (replay(&first).unwrap(), replay(&second).unwrap());
    assert_eq!((&whole.difference, whole.has_history), (&None, false));
    assert_eq!((&rerun.difference, rerun.has_history), (&None, true));
    assert!(rerun.messages > 20 && rerun.messages < whole.messages, "{} of {}", rerun.messages, whole.messages);
    let time_us = forge(&mut second, rerun.start_us.unwrap() + 300_000, |telemetry| telemetry.free_knots += 1);
    differs(&replay(&second).unwrap(), time_us, "free places for knots");
}

/// Changes one tick of the first Ticks message after a time. Returns the device time of the message, us.
fn forge_tick(capture: &mut Capture, after_us: u64, change: impl Fn(&mut Ticks, &mut Vec<Tick>)) -> u64 {
    replace(capture, |message| match message {
        DeviceMessage::Ticks(message) if message.time_us > after_us => {
            let time_us = message.time_us;
            let mut ticks: Vec<Tick> = message.ticks.iter().collect();
            change(message, &mut ticks);
            message.ticks = Batch::new();
            ticks.iter().for_each(|tick| message.ticks.push(tick).unwrap());
            Some(time_us)
        }
        _ => None,
    })
}

#[test]
fn run_with_the_codes_of_every_tick_is_run_again_bit_for_bit() {
    let scene = softlimb_scene::parse(ONE_FINGER, "minimal.toml").unwrap();
    let (captures, _) = served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        [(); 2].map(|()| {
            let folder = tempfile::tempdir().unwrap();
            let (port, cancel) = ((&address(text), Some(SampleRequest::Codes)), AtomicBool::new(false));
            let limb = softlimb_limb::Limb::new(&scene).unwrap();
            let plan = softlimb_motion::plan(&scene, &limb).unwrap();
            let files = run_behind(&scene, (limb, plan), port, None, folder.path(), &cancel, |_| ()).unwrap();
            read_capture(files.log).unwrap()
        })
    });
    let [whole, second] = captures;
    assert!(whole.ticks.is_empty(), "a device behind a port does not show its ticks");
    let rerun = replay(&whole).unwrap();
    assert_eq!((&rerun.difference, rerun.gap_us, rerun.is_exact), (&None, None, true));
    assert!(rerun.ticks_compared > 1_000 && rerun.messages_missing == 0, "{rerun:?}");

    let start_us = rerun.start_us.unwrap();
    // Codes of some ticks, 2.5 kPa higher: the controller decides on other coil times.
    let mut capture = whole.clone();
    let time_us = forge_tick(&mut capture, start_us + 100_000, |_, ticks| {
        ticks.iter_mut().for_each(|tick| tick.codes.iter_mut().for_each(|code| *code += 40));
    });
    let difference = replay(&capture).unwrap().difference.unwrap();
    assert!((time_us..time_us + 50_000).contains(&difference.device_us), "{difference:?} behind {time_us}");
    // A checksum of outputs.
    let mut capture = whole.clone();
    let time_us = forge_tick(&mut capture, start_us + 100_000, |_, ticks| ticks[3].outputs_crc ^= 1);
    differs(&replay(&capture).unwrap(), time_us + 3_000, "coils, supply valve, pump and digital outputs");
    // A measurement that the codes decide.
    let mut capture = whole.clone();
    let time_us = forge(&mut capture, start_us + 100_000, |telemetry| telemetry.channels[0].duty ^= 1);
    differs(&replay(&capture).unwrap(), time_us, "channel 0, duty, 1/127");
    // Ticks that did not arrive.
    let mut capture = whole;
    let time_us = forge_tick(&mut capture, start_us + 100_000, |message, _| message.time_us += 500_000);
    let broken = replay(&capture).unwrap();
    assert_eq!((broken.difference, broken.gap_us), (None, Some(time_us)));
    assert!(broken.ticks_compared < rerun.ticks_compared);

    // The second run begins with sensors and a state that the log does not have.
    let later = replay(&second).unwrap();
    assert_eq!((&later.difference, later.is_exact, later.has_history), (&None, false, true));
}

#[cfg(unix)]
#[test]
fn terminal_that_is_closed_is_told() {
    let terminal = ClientPort::terminal().unwrap();
    let text = terminal.address().unwrap();
    let mut port = Port::open(&address(&text)).unwrap();
    assert!(received(&mut port, 0).unwrap().is_empty());
    drop(terminal);
    let error = received(&mut port, 1).unwrap_err().to_string();
    assert!(error.starts_with(&format!("{text} is gone: unplugged")), "{error}");
}

/// Number of samples each 2 ms in a log without a gap, of one channel, and the time behind the last one, s.
fn samples_in(log: &Path) -> (u32, f64) {
    let bytes = std::fs::read(log).unwrap();
    let (mut next_s, mut count) = (None, 0);
    for message in mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap) {
        if message.channel.topic != "/softlimb/samples" {
            continue;
        }
        // By the layout of the definition, behind the four bytes of the encapsulation and a header of 24.
        let at = |from: usize| f64::from_le_bytes(message.data[from..from + 8].try_into().unwrap());
        let word = |from: usize| u32::from_le_bytes(message.data[from..from + 4].try_into().unwrap());
        let (time_s, period_s, [left_out, channels, rows]) = (at(28), at(36), [44, 48, 52].map(word));
        assert_eq!((period_s, left_out, channels), (0.002, 0, 1));
        assert!(next_s.is_none_or(|next_s: f64| (time_s - next_s).abs() < 1e-9), "{time_s} after {next_s:?}");
        next_s = Some(time_s + period_s * f64::from(rows));
        count += rows;
    }
    (count, next_s.expect("the log has samples"))
}

#[test]
fn samples_of_a_run_and_of_a_recording_are_in_their_logs() {
    let scene = softlimb_scene::parse(ONE_FINGER, "minimal.toml").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let recorded = folder.path().join("recorded.mcap");
    served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        let limb = softlimb_limb::Limb::new(&scene).unwrap();
        let plan = softlimb_motion::plan(&scene, &limb).unwrap();
        let (port, cancel) = ((&address(text), Some(SampleRequest::Measurements(2_000))), AtomicBool::new(false));
        run_behind(&scene, (limb, plan), port, None, folder.path(), &cancel, |_| ()).unwrap();
        // The session of the run is over once it is silent, and the device keeps its configuration.
        thread::sleep(Duration::from_millis(1_000));
        let stop = AtomicBool::new(false);
        thread::scope(|scope| {
            let port = Port::open(&address(text)).unwrap();
            let recording = scope.spawn(|| record_behind(port, Some((2_000, None)), &recorded, &stop));
            thread::sleep(Duration::from_millis(1_500));
            stop.store(true, Ordering::Relaxed);
            assert!(recording.join().unwrap().unwrap().samples > 0);
        });
    });
    // The run takes 0.4 s, and the vent after it longer.
    let (count, end_s) = samples_in(&folder.path().join("run.mcap"));
    assert!(count >= 200 && end_s >= 0.4, "{count} to {end_s}");
    let (count, end_s) = samples_in(&recorded);
    assert!(count >= 200 && end_s >= 0.4, "{count} to {end_s}");
}

#[test]
fn samples_of_a_device_without_a_configuration_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("none.mcap");
    served(ClientPort::tcp("127.0.0.1:0").unwrap(), |text| {
        let port = Port::open(&address(text)).unwrap();
        let error = record_behind(port, Some((2_000, None)), &log, &AtomicBool::new(false)).unwrap_err().to_string();
        assert!(error.contains("it has no configuration"), "{error}");
    });
    assert!(!log.exists());
}
