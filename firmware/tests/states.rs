//! Every transition of the state table, through the link and the tick.

use crate::common::fixture::{Fixture, NOMINAL, Truth};
use crate::common::{Bench, SESSION, system};
use softlimb_firmware::{TickOutputs, ValvePulse};
use softlimb_protocol::*;

const PRESSURE: [SetpointKind; 1] = [SetpointKind::Pressure];

fn assert_closed(outputs: &TickOutputs) {
    assert!(outputs.valves.iter().all(|&pulse| pulse == ValvePulse::CLOSED));
}

#[test]
fn without_configuration_the_device_is_idle_and_safe() {
    let mut bench = Bench::new();
    let outputs = bench.ticks(100);
    assert_eq!(bench.controller.state(), DeviceState::Idle);
    assert_eq!(outputs, TickOutputs::SAFE);
    assert!(bench.messages.iter().all(|m| !matches!(m, DeviceMessage::Telemetry(_))), "nothing to measure yet");
}

#[test]
fn idle_becomes_ready_when_all_sensors_are_plausible_and_zeroed() {
    let mut bench = Bench::new();
    bench.hello();
    bench.code[1] = Some(0);
    bench.configure(&system(), &crate::common::channels(&[SetpointKind::Pressure; 2]));
    bench.ticks(200);
    assert_eq!(bench.controller.state(), DeviceState::Idle, "a sensor is open");
    bench.code[1] = None;
    let ticks = bench.ticks_until(DeviceState::Ready, 700);
    assert!((534..=536).contains(&ticks), "3 samples to believe the sensor, 532 for the zero: {ticks}");
}

#[test]
fn zero_beyond_three_percent_forbids_ready_until_vented() {
    let mut bench = Bench::new();
    bench.hello();
    bench.pressure_pa[0] = 8e3;
    bench.configure(&system(), &crate::common::channels(&PRESSURE));
    bench.ticks(600);
    assert_eq!(bench.controller.state(), DeviceState::Idle);
    assert_eq!(bench.told_faults(), [(FaultCode::SensorImplausible, 0)]);
    assert_eq!(bench.command(CommandCode::Vent).result, ResultCode::Ok);
    bench.ticks(400);
    bench.pressure_pa[0] = 0.0;
    bench.ticks_until(DeviceState::Ready, 2_000);
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::WrongState, "the fault is still latched");
    assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
    assert_eq!(bench.controller.faults().bits(), 0);
}

#[test]
fn sensor_with_a_bad_zero_still_stops_the_device_when_it_fails() {
    let mut bench = Bench::new();
    bench.hello();
    bench.pressure_pa[0] = 8e3;
    bench.configure(&system(), &crate::common::channels(&PRESSURE));
    bench.ticks(600);
    assert_eq!(bench.told_faults(), [(FaultCode::SensorImplausible, 0)]);
    bench.command(CommandCode::Vent);
    assert_eq!(bench.command(CommandCode::Hold).result, ResultCode::Ok);
    bench.code[0] = Some(0);
    bench.ticks(3);
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
}

#[test]
fn small_offset_is_taken_away() {
    let mut bench = Bench::new();
    bench.hello();
    bench.pressure_pa[0] = 4e3;
    bench.configure(&system(), &crate::common::channels(&PRESSURE));
    bench.ticks_until(DeviceState::Ready, 600);
    bench.pressure_pa[0] = 54e3;
    bench.tick();
    let pressure_pa = bench.controller.channel(0).unwrap().pressure_pa();
    assert!((pressure_pa - 50e3).abs() < 70.0, "{pressure_pa}");
}

/// The vent lets the air of the fixture out in less than half a second, a tenth of that conductance in seconds.
#[test]
fn air_that_is_left_in_a_chamber_is_no_zero() {
    for conductance in [1.0, 0.1] {
        let mut bench = Bench::new();
        bench.hello();
        bench.attach(1, 5.1e3);
        let truth = Truth { valve_c: conductance * NOMINAL.valve_c, ..NOMINAL };
        bench.fixtures[0] = Fixture::new(truth, 5.1e3);
        bench.configure(&system(), &crate::common::channels(&PRESSURE));
        let ticks = bench.ticks_until(DeviceState::Ready, 5_000);
        let (read_pa, true_pa) = (bench.controller.channel(0).unwrap().pressure_pa(), bench.fixtures[0].gauge_pa());
        println!("conductance times {conductance}: after {ticks} ms {true_pa:.0} Pa are left, {read_pa:.0} Pa read");
        assert!(true_pa < 100.0 && (f64::from(read_pa) - true_pa).abs() < 170.0, "{conductance}: {read_pa} {true_pa}");
    }
}

#[test]
fn reading_that_does_not_come_to_rest_is_named() {
    let mut bench = Bench::new();
    bench.hello();
    bench.configure(&system(), &crate::common::channels(&PRESSURE));
    for tick in 0..6_000 {
        bench.pressure_pa[0] = 0.5 * f64::from(tick);
        bench.tick();
        assert_eq!(bench.controller.state(), DeviceState::Idle);
        assert!(tick > 5_000 || bench.told_faults().is_empty(), "tick {tick}");
    }
    assert_eq!(bench.told_faults(), [(FaultCode::SensorImplausible, 0)]);
}

#[test]
fn start_runs_and_the_end_of_the_knots_holds_with_all_valves_closed() {
    let mut bench = Bench::running(2, 50_000, 5);
    bench.attach(2, 46e3);
    let mut moved = false;
    while bench.controller.state() == DeviceState::Running {
        let outputs = bench.tick();
        moved |= outputs.valves[0].fill_us > 0;
        if bench.controller.state() == DeviceState::Holding {
            assert_closed(&outputs);
        }
    }
    assert!(moved);
    assert_eq!(bench.controller.state(), DeviceState::Holding);
    assert_eq!(bench.told_faults(), [(FaultCode::SetpointsExhausted, SYSTEM_CHANNEL)]);
    assert_closed(&bench.ticks(100));
}

#[test]
fn start_takes_effect_at_its_time() {
    let mut bench = Bench::ready(&PRESSURE);
    let start_us = bench.now_us + 50_000;
    bench.setpoint(0, start_us + 10_000, &[1_000]);
    bench.setpoint(1, start_us + 100_000, &[1_000]);
    let start = Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us };
    assert_eq!(bench.request(&start.into()).result, ResultCode::Ok);
    assert_eq!(bench.ticks_until(DeviceState::Running, 100), 51, "50 ms, and the tick in which it happens");
}

#[test]
fn nothing_starts_without_knots_with_past_knots_or_with_a_low_supply() {
    let mut bench = Bench::ready(&PRESSURE);
    let empty = bench.command(CommandCode::Start);
    assert_eq!((empty.result.known(), empty.detail), (Some(ResultCode::WrongState), 4));
    bench.setpoint(0, bench.now_us + 10_000, &[1_000]);
    bench.setpoint(1, bench.now_us + 900_000, &[1_000]);
    bench.ticks(20);
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Late, "the first knot would be skipped");
    bench.command(CommandCode::Flush);
    bench.setpoint(0, bench.now_us + 10_000, &[1_000]);
    bench.supply_pa = 140e3;
    bench.tick();
    let low = bench.command(CommandCode::Start);
    assert_eq!((low.result.known(), low.detail), (Some(ResultCode::WrongState), 5));
}

#[test]
fn armed_start_is_dropped_without_a_word_when_the_supply_is_low_by_then() {
    let mut bench = Bench::ready(&PRESSURE);
    let start_us = bench.now_us + 50_000;
    bench.setpoint(0, start_us + 10_000, &[1_000]);
    let start = Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us };
    assert_eq!(bench.request(&start.into()).result, ResultCode::Ok);
    bench.ticks(45);
    bench.supply_pa = 140e3;
    bench.ticks(20);
    bench.supply_pa = 200e3;
    bench.ticks(200);
    assert_eq!(bench.controller.state(), DeviceState::Ready);
    assert!(bench.told_faults().is_empty());
}

#[test]
fn hold_closes_the_valves_in_the_next_tick_and_start_resumes() {
    let mut bench = Bench::running(1, 80_000, 50);
    bench.ticks(45);
    assert_eq!(bench.command(CommandCode::Hold).result, ResultCode::Ok);
    assert_closed(&bench.tick());
    assert_eq!(bench.controller.state(), DeviceState::Holding);
    bench.ticks(40);
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Late, "knots have passed while holding");
    bench.command(CommandCode::Flush);
    bench.setpoint(0, bench.now_us + 20_000, &[80_000]);
    bench.setpoint(1, bench.now_us + 500_000, &[80_000]);
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
    bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Running);
}

#[test]
fn vent_ramps_down_opens_the_vents_and_ends_ready() {
    let mut bench = Bench::running(2, 40_000, 50);
    bench.attach(2, 40e3);
    bench.ticks(100);
    assert_eq!(bench.command(CommandCode::Vent).result, ResultCode::Ok);
    let begin_us = bench.now_us;
    while !bench.controller.channel(0).unwrap().is_venting_open() {
        bench.tick();
        let ramp_pa = 40e3 - 20e3 * (bench.now_us - begin_us) as f64 * 1e-6;
        let error_pa = bench.fixtures[0].gauge_pa() - ramp_pa;
        assert!(error_pa.abs() < 1.5e3, "{error_pa} Pa off the ramp at {ramp_pa} Pa");
    }
    let outputs = bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Venting);
    assert_eq!(outputs.valves[0], ValvePulse::VENTING, "open at the end of the ramp");
    assert!(!outputs.supply_open);
    bench.ticks_until(DeviceState::Ready, 2_000);
    assert!(bench.fixtures[0].gauge_pa() < 2.1e3);
    assert_closed(&bench.tick());
}

#[test]
fn hold_stops_a_vent() {
    let mut bench = Bench::running(1, 40_000, 50);
    bench.pressure_pa[0] = 40e3;
    bench.command(CommandCode::Vent);
    bench.ticks(100);
    assert_eq!(bench.command(CommandCode::Hold).result, ResultCode::Ok);
    assert_closed(&bench.tick());
    assert_eq!(bench.controller.state(), DeviceState::Holding);
    assert_eq!(bench.command(CommandCode::Vent).result, ResultCode::Ok);
    assert_eq!(bench.controller.state(), DeviceState::Venting);
}

#[test]
fn emergency_stop_vents_everything_in_one_tick_from_every_state() {
    for state in 0..5 {
        let mut bench = match state {
            0 => Bench::new(),
            1 => Bench::ready(&PRESSURE),
            _ => Bench::running(1, 50_000, 50),
        };
        match state {
            3 => assert_eq!(bench.command(CommandCode::Hold).result, ResultCode::Ok),
            4 => assert_eq!(bench.command(CommandCode::Vent).result, ResultCode::Ok),
            _ => {}
        }
        bench.emergency_stop = true;
        let outputs = bench.tick();
        assert_eq!(bench.controller.state(), DeviceState::Faulted);
        assert_eq!(outputs.valves[0], ValvePulse::VENTING, "state {state}");
        assert_eq!((outputs.supply_open, outputs.pump_duty), (false, 0));
    }
}

#[test]
fn faulted_device_is_cleared_to_rest_and_never_moves_by_itself() {
    let mut bench = Bench::running(1, 50_000, 60);
    bench.ticks(30);
    bench.emergency_stop = true;
    bench.tick();
    let refused = bench.command(CommandCode::ClearFaults);
    assert_eq!((refused.result.known(), refused.detail), (Some(ResultCode::WrongState), 7), "still pressed");
    bench.emergency_stop = false;
    bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Faulted, "latched");
    for code in [CommandCode::Start, CommandCode::Hold, CommandCode::Vent] {
        assert_eq!(bench.command(code).result, ResultCode::WrongState);
    }
    assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
    for _ in 0..2_000 {
        assert_closed(&bench.tick());
    }
    assert_eq!(bench.controller.state(), DeviceState::Ready);
    assert_eq!(bench.controller.queue().next_index(), 0, "the old knots are gone");
}

#[test]
fn commands_that_the_table_does_not_know_are_refused() {
    let mut idle = Bench::new();
    idle.hello();
    for code in [CommandCode::Start, CommandCode::Hold, CommandCode::Vent] {
        assert_eq!(idle.command(code).result, ResultCode::WrongState, "{code:?}");
    }
    let mut ready = Bench::ready(&PRESSURE);
    assert_eq!(ready.command(CommandCode::Hold).result, ResultCode::WrongState);
    let mut running = Bench::running(1, 1_000, 50);
    assert_eq!(running.command(CommandCode::Start).result, ResultCode::WrongState);
    let unknown = Command { session: SESSION, code: Code::from_raw(99), time_us: 0 };
    let ack = running.request(&unknown.into());
    assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::UnknownCode), 1));
}

#[test]
fn sensor_that_has_drifted_is_found_when_the_chambers_were_vented() {
    for (drift_pa, is_found) in [(5e3, false), (-5e3, false), (7e3, false), (-7e3, true)] {
        let mut bench = Bench::new();
        bench.hello();
        bench.pressure_pa[0] = 2e3;
        bench.configure(&system(), &crate::common::channels(&PRESSURE));
        bench.ticks_until(DeviceState::Ready, 600);
        assert_eq!(bench.command(CommandCode::Vent).result, ResultCode::Ok);
        bench.pressure_pa[0] = 2e3 + drift_pa;
        // An offset that reads as a pressure keeps the vents open for their longest time.
        bench.ticks_until(DeviceState::Idle, 9_000);
        bench.ticks(100);
        let expected = if is_found { DeviceState::Idle } else { DeviceState::Ready };
        assert_eq!(bench.controller.state(), expected, "{drift_pa} Pa");
        let told = bench.told_faults();
        assert_eq!(told.contains(&(FaultCode::SensorImplausible, 0)), is_found, "{drift_pa} Pa: {told:?}");
        // The zero stays that of the empty chamber: it does not follow the drift.
        let pressure_pa = bench.controller.channel(0).unwrap().pressure_pa();
        assert!((f64::from(pressure_pa) - drift_pa).abs() < 70.0, "{drift_pa} Pa: {pressure_pa}");
        if is_found {
            assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
            bench.ticks(100);
            assert_eq!(bench.command(CommandCode::Start).result, ResultCode::WrongState, "still off");
            bench.pressure_pa[0] = 2e3;
            bench.ticks_until(DeviceState::Ready, 600);
        }
    }
}
