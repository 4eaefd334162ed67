//! Operation by hand: pulses of single valves, and zeros taken anew.

use crate::common::{Bench, SENSOR_MAX_PA};
use softlimb_firmware::ValvePulse;
use softlimb_protocol::*;

const TWO: [SetpointKind; 2] = [SetpointKind::Pressure; 2];

/// Coil times of a channel, fill and vent, us, over so many ticks; no other channel has any.
fn coils_us(bench: &mut Bench, channel: usize, ticks: usize) -> (u32, u32) {
    let mut total = (0, 0);
    for _ in 0..ticks {
        for (index, pulse) in bench.tick().valves.into_iter().enumerate() {
            if index == channel {
                total = (total.0 + u32::from(pulse.fill_us), total.1 + u32::from(pulse.vent_us));
            } else {
                assert_eq!(pulse, ValvePulse::CLOSED, "channel {index}");
            }
        }
    }
    total
}

#[test]
fn pulse_opens_one_valve_for_its_time_and_closes_by_itself() {
    for duration_us in [1_000, 20_000, 33_300, 1_000_000] {
        let mut bench = Bench::ready(&TWO);
        assert_eq!(bench.pulse(1, PulseDirection::Fill, duration_us).result, ResultCode::Ok);
        assert_eq!(coils_us(&mut bench, 1, 1_100), (duration_us, 0));
        assert_eq!(bench.pulse(0, PulseDirection::Vent, duration_us).result, ResultCode::Ok);
        assert_eq!(coils_us(&mut bench, 0, 1_100), (0, duration_us));
        assert_eq!(bench.controller.state(), DeviceState::Holding, "the device holds the pressure");
    }
}

#[test]
fn venting_by_hand_leaves_a_ready_device_ready_and_filling_has_it_hold() {
    let mut bench = Bench::ready(&TWO);
    bench.pulse(0, PulseDirection::Vent, 5_000);
    bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Ready);
    bench.pulse(0, PulseDirection::Fill, 5_000);
    assert_eq!(bench.controller.state(), DeviceState::Holding);
    bench.ticks(10);
    assert_eq!(bench.controller.faults().bits(), 0);
}

#[test]
fn chamber_filled_by_hand_is_let_down_when_the_host_is_gone() {
    let mut bench = Bench::ready(&TWO);
    bench.attach(2, 0.0);
    bench.pulse(0, PulseDirection::Fill, 100_000);
    bench.ticks(150);
    assert!(bench.controller.channel(0).unwrap().pressure_pa() > 20e3);
    bench.heartbeats = false;
    let ticks = bench.ticks_until(DeviceState::Venting, 3_000);
    assert!((1_800..2_000).contains(&ticks), "the hold time of 2 s counts from the pulse: {ticks}");
    bench.ticks_until(DeviceState::Ready, 20_000);
    assert!(bench.controller.channel(0).unwrap().pressure_pa() < 2e3);
}

#[test]
fn second_pulse_replaces_the_first() {
    let mut bench = Bench::ready(&TWO);
    bench.pulse(0, PulseDirection::Fill, 500_000);
    assert_eq!(coils_us(&mut bench, 0, 10), (10_000, 0));
    bench.pulse(0, PulseDirection::Vent, 3_000);
    assert_eq!(coils_us(&mut bench, 0, 600), (0, 3_000));
}

#[test]
fn filling_ends_where_the_references_end() {
    // At 147 kPa of 150 kPa.
    let mut bench = Bench::ready(&TWO);
    bench.pressure_pa[0] = 146e3;
    bench.pulse(0, PulseDirection::Fill, 500_000);
    assert_eq!(coils_us(&mut bench, 0, 5), (5_000, 0));
    bench.pressure_pa[0] = 148e3;
    assert_eq!(coils_us(&mut bench, 0, 600), (0, 0));
    bench.pressure_pa[0] = 144e3;
    assert_eq!(coils_us(&mut bench, 0, 600), (0, 0), "what has ended does not go on");
    bench.pressure_pa[0] = 148e3;
    bench.pulse(0, PulseDirection::Vent, 20_000);
    assert_eq!(coils_us(&mut bench, 0, 600), (0, 20_000), "air may leave");
    assert_eq!(bench.controller.faults().bits(), 0);
}

#[test]
fn faults_end_a_pulse_as_they_end_everything() {
    type Cause = fn(&mut Bench);
    let causes: [(FaultCode, u8, Cause); 4] = [
        (FaultCode::OverPressure, 0, |bench| bench.pressure_pa[0] = 190e3),
        (FaultCode::SensorImplausible, 1, |bench| bench.code[1] = Some(0)),
        (FaultCode::SupplyHigh, SYSTEM_CHANNEL, |bench| bench.supply_pa = 400e3),
        (FaultCode::EmergencyStop, SYSTEM_CHANNEL, |bench| bench.emergency_stop = true),
    ];
    for (code, channel, cause) in causes {
        let mut bench = Bench::ready(&TWO);
        bench.pulse(0, PulseDirection::Fill, 1_000_000);
        assert_eq!(coils_us(&mut bench, 0, 10), (10_000, 0));
        cause(&mut bench);
        bench.ticks_until(DeviceState::Faulted, 20);
        let filled = (0..1_000).any(|_| bench.tick().valves.iter().any(|pulse| pulse.fill_us > 0));
        assert!(!filled, "{code:?}");
        assert_eq!(bench.told_faults(), [(code, channel)]);
    }
}

#[test]
fn pulse_does_not_outlast_its_state() {
    let mut bench = Bench::ready(&TWO);
    bench.pulse(0, PulseDirection::Fill, 1_000_000);
    bench.ticks(5);
    bench.command(CommandCode::Vent);
    let filled = (0..1_000).any(|_| bench.tick().valves.iter().any(|pulse| pulse.fill_us > 0));
    assert!(!filled);
}

#[test]
fn impossible_pulse_is_refused_by_its_field() {
    let mut bench = Bench::ready(&TWO);
    let out_of_range = ResultCode::OutOfRange.into();
    for (channel, duration_us, field) in [(2, 20_000, 1), (255, 20_000, 1), (0, 999, 3), (0, 1_000_001, 3), (0, 0, 3)] {
        let ack = bench.pulse(channel, PulseDirection::Fill, duration_us);
        assert_eq!((ack.result, ack.detail), (out_of_range, field), "{channel} {duration_us}");
    }
    let pulse =
        ManualPulse { session: crate::common::SESSION, channel: 0, direction: Code::from_raw(2), duration_us: 20_000 };
    let ack = bench.request(&pulse.into());
    assert_eq!((ack.result, ack.detail), (ResultCode::UnknownCode.into(), 2));
    assert_eq!(coils_us(&mut bench, 0, 100), (0, 0));
    assert_eq!(bench.controller.state(), DeviceState::Ready);
}

#[test]
fn zero_is_the_mean_of_new_samples_with_the_vents_open() {
    let mut bench = Bench::ready(&TWO);
    bench.pressure_pa[1] = 5e3;
    bench.ticks(10);
    assert!((bench.controller.channel(1).unwrap().pressure_pa() - 5e3).abs() < 50.0);
    assert_eq!(bench.command(CommandCode::Zero).result, ResultCode::Ok);
    assert_eq!(bench.controller.state(), DeviceState::Idle);
    for tick in 1..532 {
        let outputs = bench.tick();
        assert_eq!(bench.controller.state(), DeviceState::Idle, "tick {tick}");
        assert_eq!(outputs.valves[..2], [ValvePulse::VENTING; 2], "tick {tick}");
        assert!(!outputs.supply_open);
    }
    assert_eq!(bench.tick().valves[..2], [ValvePulse::CLOSED; 2]);
    assert_eq!(bench.controller.state(), DeviceState::Ready);
    assert!(bench.controller.channel(1).unwrap().pressure_pa().abs() < 50.0);
    bench.pressure_pa[1] = 0.0;
    bench.tick();
    assert!((bench.controller.channel(1).unwrap().pressure_pa() + 5e3).abs() < 50.0);
}

#[test]
fn zero_is_refused_while_a_chamber_is_under_pressure() {
    let limit_pa = 0.03 * f64::from(SENSOR_MAX_PA);
    for (pressure_pa, taken) in [(limit_pa - 60.0, true), (limit_pa + 60.0, false), (100e3, false)] {
        let mut bench = Bench::ready(&TWO);
        bench.pressure_pa[1] = pressure_pa;
        bench.ticks(3);
        let ack = bench.command(CommandCode::Zero);
        if taken {
            assert_eq!(ack.result, ResultCode::Ok);
        } else {
            let code = FaultCode::SensorImplausible as u32;
            assert_eq!((ack.result, ack.detail), (ResultCode::WrongState.into(), code), "{pressure_pa}");
            assert_eq!(bench.controller.state(), DeviceState::Ready);
            // The converter resolves 63 Pa.
            let found_pa = f64::from(bench.controller.channel(1).unwrap().pressure_pa());
            assert!((found_pa - pressure_pa).abs() < 70.0, "the zero is as before: {found_pa}");
        }
    }
}

#[test]
fn zero_does_not_creep_with_repetition() {
    // A zero that is within the limit of the last one is not within that of the sensor.
    let mut bench = Bench::ready(&TWO);
    for _ in 0..2 {
        bench.pressure_pa[0] += 4e3;
        bench.ticks(3);
        let ack = bench.command(CommandCode::Zero);
        assert_eq!(ack.result == ResultCode::Ok, bench.pressure_pa[0] < 6e3);
        bench.ticks(50);
    }
}
