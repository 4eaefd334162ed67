//! The simulated device as a whole: time, line, determinism, and that controller and plant are really joined.

use crate::common::{Host, SESSION, settings};
use softlimb_plant::PartFault;
use softlimb_protocol::*;
use softlimb_sim::{LineFaults, SimError, SimulatedMcu};

const HELLO: Hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION };

/// A second of 40 kPa on every channel, started.
fn start(host: &mut Host, channels: usize) {
    let first_us = host.mcu.device_time_us() + 60_000;
    for index in 0..50 {
        host.setpoint(index, first_us + u64::from(index) * 20_000, &vec![40_000; channels]);
    }
    host.wait(40_000);
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: first_us });
    host.wait(900_000);
}

#[test]
fn hello_takes_its_time_on_the_wire_and_is_answered_at_a_tick() {
    let mut slow = settings(1);
    slow.baud = 9_600;
    let mut host = Host::new(&slow);
    host.send(HELLO);
    // Delimiters, COBS overhead, type, seq, version, hash, session, CRC: 18 bytes of 10 bits, 18.75 ms, processed at the tick of 19 ms.
    host.wait(18_999);
    let mut answer = Vec::new();
    host.mcu.advance_to(19_000);
    host.mcu.read(&mut answer);
    assert_eq!(answer, []);
    // The reply has 2 + 1 + 3 + 36 + 4 bytes, 47.92 ms.
    host.wait(47_000);
    assert!(host.heard.is_empty());
    host.wait(1_000);
    let DeviceMessage::HelloReply(reply) = &host.heard[0].1 else { panic!("{:?}", host.heard) };
    assert_eq!((reply.mcu_time_us, reply.session), (19_000, SESSION));
}

#[test]
fn device_lives_by_its_own_clock() {
    let mut wrong = settings(1);
    (wrong.clock_offset_us, wrong.clock_drift_ppm) = (1_000_000_000, -500.0);
    let mut mcu = SimulatedMcu::new(&wrong).unwrap();
    mcu.advance_to(10_000_000);
    // 500 ppm slow: 5 ms less in 10 s; the tick that begins then has been taken up to its end.
    assert_eq!(mcu.device_time_us(), 1_000_000_000 + 9_995_000 + 1_000);
    assert_eq!(mcu.next_tick_us(), 10_001_000);
}

#[test]
fn controller_and_plant_are_joined_both_ways() {
    let mut host = Host::new(&settings(3));
    host.get_ready(3, SetpointKind::Pressure);
    start(&mut host, 3);
    let truth = host.mcu.truth();
    let shown = host.telemetry().last().unwrap();
    assert_eq!(shown.state, DeviceState::Running);
    for (channel, sample) in truth.channels.iter().zip(shown.channels.iter()) {
        assert!((channel.pressure_pa - 40e3).abs() < 2_000.0, "{}", channel.pressure_pa);
        // What the sensor shows is not the truth, but near to it.
        assert!((f64::from(sample.pressure_10pa) * 10.0 - channel.pressure_pa).abs() < 2_000.0);
    }
    let shown_supply_pa = f64::from(shown.supply_10pa) * 10.0;
    // Three standard deviations of the supply sensor's offset are 0.9 % of 689 kPa.
    assert!((shown_supply_pa - truth.supply_pressure_pa).abs() < 8_000.0, "{shown_supply_pa}");
    assert!(truth.air_used_kg > 0.0);
}

#[test]
fn pump_refills_the_reservoir() {
    let mut host = Host::new(&settings(3));
    host.get_ready(3, SetpointKind::Pressure);
    start(&mut host, 3);
    let drawn_down_pa = host.mcu.truth().supply_pressure_pa;
    for _ in 0..40 {
        host.send(Heartbeat { session: SESSION, host_time_us: 0 });
        host.wait(50_000);
    }
    assert!(host.mcu.truth().supply_pressure_pa > drawn_down_pa + 2e3);
}

#[test]
fn emergency_stop_vents_at_once() {
    let mut host = Host::new(&settings(1));
    host.get_ready(1, SetpointKind::Pressure);
    start(&mut host, 1);
    host.mcu.set_emergency_stop(true);
    host.wait(3_000);
    assert_eq!(host.mcu.controller().state(), DeviceState::Faulted);
    host.wait(2_000_000);
    assert!(host.mcu.truth().channels[0].pressure_pa < 1_000.0);
}

#[test]
fn same_seed_and_bytes_give_the_same_bits_and_another_seed_does_not() {
    let run = |plant_seed, line_seed| {
        let mut settings = settings(2);
        (settings.plant.seed, settings.seed) = (plant_seed, line_seed);
        settings.line_faults = LineFaults { drop: 1e-4, flip: 1e-4, duplicate: 1e-4 };
        let mut host = Host::new(&settings);
        host.mcu.set_line_faults(LineFaults::NONE).unwrap();
        host.get_ready(2, SetpointKind::BendAngle);
        host.mcu.set_line_faults(settings.line_faults).unwrap();
        let first_us = host.mcu.device_time_us() + 100_000;
        for index in 0..50 {
            host.setpoint(index, first_us + u64::from(index) * 20_000, &[400_000, 300_000]);
        }
        host.send(Command { session: SESSION, code: CommandCode::Start.into(), time_us: first_us });
        host.wait(1_500_000);
        (host.bytes, host.mcu.truth())
    };
    let first = run(3, 1);
    assert!(first == run(3, 1));
    assert!(first.0 != run(3, 2).0, "other faults on the line");
    assert!(first.1 != run(4, 1).1, "another plant");
}

#[test]
fn time_that_passes_in_other_steps_is_the_same_time() {
    let run = |steps_us: &[u64]| {
        let mut mcu = SimulatedMcu::new(&settings(1)).unwrap();
        let mut frame = [0; MAX_FRAME_LEN];
        let len = encode_frame(&HostMessage::from(HELLO), 0, &mut frame).unwrap();
        mcu.write(&frame[..len]);
        let mut bytes = Vec::new();
        for &step_us in steps_us {
            mcu.advance_to(mcu.now_us() + step_us);
            mcu.read(&mut bytes);
        }
        (bytes, mcu.truth())
    };
    let at_once = run(&[20_000]);
    assert!(!at_once.0.is_empty());
    assert!(at_once == run(&[17; 1_176].iter().copied().chain([8]).collect::<Vec<_>>()));
}

#[test]
fn broken_sensor_reaches_the_controller() {
    let mut host = Host::new(&settings(2));
    host.get_ready(2, SetpointKind::Pressure);
    host.mcu.inject(1, PartFault::SensorOpen).unwrap();
    host.wait(20_000);
    let told = host.heard.iter().find_map(|(_, message)| match message {
        DeviceMessage::Fault(fault) => Some((fault.code.known(), fault.channel)),
        _ => None,
    });
    assert_eq!(told, Some((Some(FaultCode::SensorImplausible), 1)));
}

#[test]
fn settings_out_of_range_are_named() {
    let refused = |change: &dyn Fn(&mut softlimb_sim::SimSettings)| {
        let mut settings = settings(1);
        change(&mut settings);
        SimulatedMcu::new(&settings).unwrap_err().to_string()
    };
    assert_eq!(refused(&|s| s.baud = 300), "baud = 300 is not allowed: 1200 to 100000000");
    assert!(refused(&|s| s.clock_drift_ppm = f64::NAN).starts_with("clock_drift_ppm = NaN"));
    assert!(refused(&|s| s.line_faults.flip = 1.5).starts_with("line_faults.flip = 1.5"));
    assert!(refused(&|s| s.plant.temperature_k = 0.0).starts_with("temperature_k = 0"));
    let error = SimulatedMcu::new(&settings(28)).unwrap_err();
    assert_eq!(error, SimError::TooManyChannels { channels: 28, max: 27 });
}
