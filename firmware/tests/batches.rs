//! Several knots in a frame, several samples in a message.

use crate::common::{Bench, SESSION};
use softlimb_firmware::TickOutputs;
use softlimb_protocol::*;

const OFF: Outputs = Outputs::from_bits(0);

fn step(step_us: u16, outputs: Outputs, steps: &[i16]) -> KnotStep {
    KnotStep { step_us, outputs, steps: List::from_slice(steps).unwrap() }
}

fn knots(index: u32, steps: &[KnotStep]) -> HostMessage {
    let mut knots = Batch::new();
    steps.iter().for_each(|step| knots.push(step).unwrap());
    Knots { session: SESSION, index, knots }.into()
}

/// A ready device with one knot of two channels, and the time of that knot.
fn with_a_knot() -> (Bench, u64) {
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 2]);
    let first_us = bench.now_us + 100_000;
    assert_eq!(bench.setpoint(0, first_us, &[10_000, 20_000]).result, ResultCode::Ok);
    (bench, first_us)
}

#[test]
fn steps_lead_where_whole_knots_would() {
    let (mut stepped, first_us) = with_a_knot();
    let batch = [
        step(20_000, OFF, &[500, -500]),
        step(30_000, Outputs::GRIPPER, &[32_767, -1]),
        step(22_000, OFF, &[-32_768, 0]),
    ];
    let ack = stepped.request(&knots(1, &batch));
    assert_eq!((ack.result.known(), ack.free_knots), (Some(ResultCode::Ok), 60));
    let (mut whole, _) = with_a_knot();
    // Worked by hand.
    for (index, after_us, outputs, values) in [
        (1, 20_000, OFF, [10_500, 19_500]),
        (2, 50_000, Outputs::GRIPPER, [43_267, 19_499]),
        (3, 72_000, OFF, [10_499, 19_499]),
    ] {
        assert_eq!(whole.knot(index, first_us + after_us, outputs, &values).result, ResultCode::Ok);
    }
    for at_us in [0, 7_000, 20_000, 35_500, 50_000, 50_001, 72_000, 90_000] {
        for channel in 0..2 {
            let value = |bench: &Bench| bench.controller.queue().value(channel, first_us + at_us);
            assert_eq!(value(&stepped), value(&whole), "channel {channel} after {at_us} us");
        }
    }
    assert_eq!(stepped.controller.queue().next_index(), 4);
}

#[test]
fn refused_frame_changes_nothing_and_says_why() {
    let fine = || step(20_000, OFF, &[100, 100]);
    let unknown = Outputs::from_bits(0x40);
    for (bad, result, detail) in [
        (step(20_000, OFF, &[100]), ResultCode::WrongChannelCount, 2),
        (step(20_000, OFF, &[0, -30_000]), ResultCode::OutOfRange, 1),
        (step(20_000, unknown, &[0, 0]), ResultCode::UnknownCode, 2),
        (step(0, OFF, &[0, 0]), ResultCode::Late, 0),
        (step(20_000, OFF, &[30_000, 30_001]), ResultCode::TooFast, 1),
    ] {
        let (mut bench, first_us) = with_a_knot();
        let ack = bench.request(&knots(1, &[fine(), fine(), bad, fine()]));
        assert_eq!((ack.result.known(), ack.detail, ack.free_knots), (Some(result), detail, 63));
        assert_eq!(bench.controller.queue().value(0, first_us + 1_000_000), Some(10_000.0));
        // What follows is accepted as if nothing had been sent, from just behind the first knot on.
        let ack = bench.request(&knots(1, &[step(1, OFF, &[1, 1]), fine()]));
        assert_eq!((ack.result.known(), ack.free_knots), (Some(ResultCode::Ok), 61));
    }
}

#[test]
fn value_beyond_32_bits_is_out_of_range() {
    let mut bench = Bench::new();
    bench.hello();
    let mut channels = crate::common::channels(&[SetpointKind::Pressure]);
    (channels[0].setpoint_min, channels[0].setpoint_max) = (i32::MIN, i32::MAX);
    bench.configure(&crate::common::system(), &channels);
    bench.ticks(550);
    bench.setpoint(0, bench.now_us + 100_000, &[i32::MAX]);
    let ack = bench.request(&knots(1, &[step(1_000, OFF, &[1])]));
    assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::OutOfRange), 0));
}

#[test]
fn frame_is_taken_whole_or_not_at_all_by_a_buffer_that_is_nearly_full() {
    let (mut bench, _) = with_a_knot();
    let one = || step(1_000, OFF, &[0, 0]);
    for index in (1..61).step_by(4) {
        assert_eq!(bench.request(&knots(index, &[one(), one(), one(), one()])).result, ResultCode::Ok);
    }
    let ack = bench.request(&knots(61, &[one(), one(), one(), one()]));
    assert_eq!((ack.result.known(), ack.free_knots), (Some(ResultCode::QueueFull), 3));
    let ack = bench.request(&knots(61, &[one(), one(), one()]));
    assert_eq!((ack.result.known(), ack.free_knots), (Some(ResultCode::Ok), 0));
}

#[test]
fn copy_of_a_frame_is_told_the_next_index_whatever_its_steps_would_do_now() {
    let (mut bench, _) = with_a_knot();
    let batch = knots(1, &[step(20_000, OFF, &[-9_000, 0]), step(20_000, OFF, &[0, 100])]);
    assert_eq!(bench.request(&batch).result, ResultCode::Ok);
    let ack = bench.request(&batch);
    assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::UnexpectedIndex), 3));
}

#[test]
fn first_knot_after_a_flush_is_whole() {
    let (mut bench, _) = with_a_knot();
    bench.command(CommandCode::Flush);
    let ack = bench.request(&knots(0, &[step(20_000, OFF, &[1, 1])]));
    assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::NoKnotBefore), 0));
}

fn sampling(bench: &mut Bench, period_us: u32, samples: u8) -> Ack {
    let content = SampleContent::Measurements.into();
    bench.request(&SetSampling { session: SESSION, period_us, samples, content }.into())
}

fn told(bench: &Bench) -> Vec<&Samples> {
    let samples = bench.messages.iter().filter_map(|message| match message {
        DeviceMessage::Samples(samples) => Some(samples),
        _ => None,
    });
    samples.collect()
}

#[test]
fn samples_come_as_often_as_asked_and_hold_what_the_sensors_show() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 9]);
    let begin_us = bench.now_us;
    assert_eq!(sampling(&mut bench, 5_000, 7).result, ResultCode::Ok);
    for tick in 0..700_u32 {
        // 100 Pa a tick: ten units of the wire every ten ticks, within the converter's 63 Pa.
        bench.pressure_pa[4] = 100.0 * f64::from(tick);
        bench.tick();
    }
    let all = told(&bench);
    assert_eq!(all.len(), 20);
    for (number, message) in (0..).zip(&all) {
        assert_eq!((message.time_us, message.period_us, message.left_out), (begin_us + 35_000 * number, 5_000, 0));
        assert_eq!(message.samples.len(), 7);
    }
    for (number, sample) in all.iter().flat_map(|message| message.samples.iter()).enumerate() {
        assert_eq!((sample.state.known(), sample.channels.len()), (Some(DeviceState::Ready), 9));
        let expected_10pa = 50.0 * number as f64;
        assert!((f64::from(sample.channels[4].pressure_10pa) - expected_10pa).abs() < 7.0, "sample {number}");
        assert_eq!(sample.channels[3].pressure_10pa, 0);
    }
}

#[test]
fn samples_end_when_asked_with_a_configuration_and_with_a_session() {
    let end: [fn(&mut Bench); 3] = [
        |bench| assert_eq!(sampling(bench, 0, 0).result, ResultCode::Ok),
        |bench| bench.configure(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure])),
        |bench| {
            bench.heartbeats = false;
            bench.ticks(1_000);
            bench.messages.clear();
            let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: 99 };
            assert_eq!(bench.request(&hello.into()).result, ResultCode::Ok);
        },
    ];
    for end in end {
        let mut bench = Bench::ready(&[SetpointKind::Pressure]);
        sampling(&mut bench, 1_000, 1);
        bench.ticks(10);
        assert_eq!(told(&bench).len(), 10);
        end(&mut bench);
        bench.messages.clear();
        bench.ticks(10);
        assert!(told(&bench).is_empty());
    }
}

#[test]
fn sampling_that_no_frame_or_clock_allows_is_refused() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 9]);
    for (period_us, samples, detail) in
        [(999, 1, 1), (1_500, 1, 1), (10_001_000, 1, 1), (1_000, 0, 2), (1_000, 8, 2), (1_000, 255, 2)]
    {
        let ack = sampling(&mut bench, period_us, samples);
        assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::OutOfRange), detail), "{period_us} {samples}");
    }
    assert_eq!(sampling(&mut bench, 10_000_000, 7).result, ResultCode::Ok);
    let mut idle = Bench::new();
    idle.hello();
    assert_eq!(sampling(&mut idle, 1_000, 1).result, ResultCode::WrongState);
}

/// A host that does not read for 200 ms at 9 x 1 kHz, one message of 251 bytes each 7 ms, fills the 2056 bytes that can wait.
#[test]
fn samples_without_room_are_counted() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 9]);
    sampling(&mut bench, 1_000, 7);
    bench.reads = false;
    bench.heartbeats = false;
    bench.ticks(203);
    bench.reads = true;
    bench.ticks(70);
    let all = told(&bench);
    let (last, count) = (all.last().unwrap(), all.iter().map(|message| message.samples.len()).sum::<usize>());
    assert!(last.left_out > 0 && last.left_out % 7 == 0, "{}", last.left_out);
    assert_eq!(count + last.left_out as usize, 273);
}

fn ticks_of(bench: &Bench) -> Vec<&Ticks> {
    let ticks = bench.messages.iter().filter_map(|message| match message {
        DeviceMessage::Ticks(ticks) => Some(ticks),
        _ => None,
    });
    ticks.collect()
}

fn request_ticks(bench: &mut Bench, samples: u8) -> Ack {
    let content = SampleContent::Ticks.into();
    bench.request(&SetSampling { session: SESSION, period_us: 1_000, samples, content }.into())
}

/// Fill and vent time of the channels, then supply valve, pump and digital outputs, as the specification orders them.
fn outputs_crc(outputs: &TickOutputs, channels: usize) -> u32 {
    let coils = outputs.valves[..channels].iter().flat_map(|valves| [valves.fill_us, valves.vent_us]);
    let mut bytes: Vec<u8> = coils.flat_map(u16::to_le_bytes).collect();
    bytes.extend([u8::from(outputs.supply_open), outputs.pump_duty, outputs.digital.bits()]);
    crc32c(&bytes)
}

#[test]
fn ticks_requested_before_a_configuration_come_from_its_first_tick_on() {
    let mut bench = Bench::new();
    bench.hello();
    assert_eq!(request_ticks(&mut bench, 5).result, ResultCode::Ok);
    bench.ticks(10);
    assert!(ticks_of(&bench).is_empty(), "no channel, no code");
    let channels = crate::common::channels(&[SetpointKind::Pressure; 2]);
    bench.configure(&crate::common::system(), &channels);
    let begin_us = bench.now_us;
    let mut expected = Vec::new();
    for tick in 0..640_u16 {
        // Within the plausible band; the stop is pressed in the last ticks.
        (bench.code[0], bench.code[1]) = (Some(410 + tick % 3), Some(411));
        bench.valve_supply_v = 24.0 + f64::from(tick % 3);
        bench.emergency_stop = tick >= 635;
        if tick == 580 {
            assert_eq!(bench.pulse(1, PulseDirection::Fill, 20_000).result, ResultCode::Ok);
        }
        let outputs = bench.tick();
        let flags = if tick >= 635 { TickFlags::EMERGENCY_STOP } else { TickFlags::default() };
        let volts = [2_707, 2_820, 2_933][usize::from(tick % 3)];
        expected.push(([410 + tick % 3, 411, volts], flags, outputs_crc(&outputs, 2)));
    }
    let mut found = Vec::new();
    for (number, message) in (0..).zip(ticks_of(&bench)) {
        assert_eq!((message.time_us, message.left_out, message.ticks.len()), (begin_us + 5_000 * number, 0, 5));
        found.extend(
            message
                .ticks
                .iter()
                .map(|tick| ([tick.codes[0], tick.codes[1], tick.valve_supply_code], tick.flags, tick.outputs_crc)),
        );
    }
    assert_eq!(found, expected);
    let of_pulse = found[581].2;
    assert!(found[..580].iter().all(|tick| tick.2 != of_pulse), "the coil of the pulse is in the checksum");
    // A later configuration does not end them, a request and another session do.
    bench.emergency_stop = false;
    bench.command(CommandCode::ClearFaults);
    assert_eq!(request_ticks(&mut bench, 255).detail, 2);
    let content = SampleContent::Ticks.into();
    bench.request(&SetSampling { session: SESSION, period_us: 0, samples: 0, content }.into());
    bench.messages.clear();
    bench.ticks(20);
    assert!(ticks_of(&bench).is_empty());
}

#[test]
fn ticks_go_on_through_another_configuration_in_messages_that_hold_them() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 1]);
    assert_eq!(request_ticks(&mut bench, 19).result, ResultCode::Ok);
    bench.ticks(30);
    bench.configure(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure; 9]));
    bench.ticks(30);
    let told: Vec<_> = ticks_of(&bench).iter().map(|message| message.ticks.len()).collect();
    assert_eq!(told, [19, 11, 8, 8, 8]);
    assert!(ticks_of(&bench).iter().all(|message| message.left_out == 0));
}

#[test]
fn ticks_are_every_tick_and_of_a_content_that_is_known() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 9]);
    for (period_us, samples, content, result, detail) in [
        (2_000, 1, SampleContent::Ticks.into(), ResultCode::OutOfRange, 1),
        (1_000, 0, SampleContent::Ticks.into(), ResultCode::OutOfRange, 2),
        (1_000, 20, SampleContent::Ticks.into(), ResultCode::OutOfRange, 2),
        (1_000, 1, Code::from_raw(2), ResultCode::UnknownCode, 3),
    ] {
        let ack = bench.request(&SetSampling { session: SESSION, period_us, samples, content }.into());
        assert_eq!((ack.result.known(), ack.detail), (Some(result), detail), "{period_us} {samples} {content:?}");
    }
}
