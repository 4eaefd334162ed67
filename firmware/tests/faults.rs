//! Faults: what detects them, how fast the outputs are safe, and what they leave alone.

use crate::common::fixture::{Fixture, NOMINAL, Truth};
use crate::common::{Bench, SESSION};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use softlimb_firmware::ValvePulse;
use softlimb_protocol::*;

fn only_fault(bench: &Bench) -> (FaultCode, u8) {
    let faults = bench.told_faults();
    assert_eq!(faults.len(), 1, "{faults:?}");
    faults[0]
}

#[test]
fn over_pressure_vents_its_channel_in_the_second_sample_and_cuts_the_supply() {
    for channel in [0, 1, 2] {
        // What the converter's steps make of 50 kPa: there is nothing to correct, and so no pulse under way.
        let mut bench = Bench::running(3, 49_943, 50);
        bench.pressure_pa[..3].fill(50e3);
        bench.ticks(45);
        bench.pressure_pa[channel] = 151e3;
        bench.tick();
        assert_eq!(bench.controller.state(), DeviceState::Running, "one sample may be noise");
        let outputs = bench.tick();
        assert_eq!(bench.controller.state(), DeviceState::Faulted);
        for (index, pulse) in outputs.valves[..3].iter().enumerate() {
            let wanted = if index == channel { ValvePulse::VENTING } else { ValvePulse::CLOSED };
            assert_eq!(*pulse, wanted, "channel {index}");
        }
        assert_eq!((outputs.supply_open, outputs.pump_duty), (false, 0));
        assert_eq!(only_fault(&bench), (FaultCode::OverPressure, channel as u8));
        let refused = bench.command(CommandCode::ClearFaults);
        assert_eq!((refused.result.known(), refused.detail), (Some(ResultCode::WrongState), 2));
        bench.pressure_pa[channel] = 20e3;
        bench.tick();
        assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
    }
}

#[test]
fn one_high_sample_at_a_time_is_no_fault() {
    let mut bench = Bench::running(1, 50_000, 50);
    bench.ticks(45);
    for _ in 0..50 {
        bench.pressure_pa[0] = 151e3;
        bench.tick();
        bench.pressure_pa[0] = 50e3;
        bench.tick();
    }
    assert_eq!(bench.controller.state(), DeviceState::Running);
}

#[test]
fn line_drop_while_filling_is_not_taken_for_over_pressure() {
    let mut bench = Bench::running(1, 147_000, 60);
    bench.attach(1, 0.0);
    let mut highest_pa = 0.0_f64;
    while bench.controller.state() == DeviceState::Running {
        bench.tick();
        highest_pa = highest_pa.max(bench.fixtures[0].manifold_pa());
    }
    assert!(highest_pa > 150e3, "the manifold does exceed the limit: {highest_pa}");
    assert_eq!(only_fault(&bench), (FaultCode::SetpointsExhausted, SYSTEM_CHANNEL));
}

#[test]
fn kinked_hose_is_noticed_and_a_narrow_one_is_not() {
    // From 80 down to 50 kPa. While filling, the manifold before a kinked hose reaches the pressure limit first.
    for (share, is_noticed) in [(0.1, true), (0.7, false), (1.0, false), (1.5, false)] {
        let mut bench = Bench::running(1, 50_000, 60);
        bench.attach(1, 80e3);
        bench.fixtures[0] = Fixture::new(Truth { line_c: share * NOMINAL.line_c, ..NOMINAL }, 80e3);
        bench.ticks(1_000);
        let faults = bench.told_faults();
        let of_air = faults.iter().any(|(code, _)| matches!(code, FaultCode::MissingAir | FaultCode::ExcessAir));
        assert_eq!(of_air, is_noticed, "{share}: {faults:?}");
    }
}

#[test]
fn sensor_out_of_its_band_for_three_samples_holds_everything() {
    for code in [0, 4095] {
        let mut bench = Bench::running(3, 50_000, 50);
        bench.ticks(45);
        bench.code[1] = Some(code);
        bench.ticks(2);
        assert_eq!(bench.controller.state(), DeviceState::Running);
        let outputs = bench.tick();
        assert_eq!(bench.controller.state(), DeviceState::Faulted);
        assert_eq!(outputs.valves[..3], [ValvePulse::CLOSED; 3]);
        assert_eq!(only_fault(&bench), (FaultCode::SensorImplausible, 1));
        let refused = bench.command(CommandCode::ClearFaults);
        assert_eq!((refused.result.known(), refused.detail), (Some(ResultCode::WrongState), 1));
    }
}

#[test]
fn after_the_hold_time_a_fault_ramps_down_and_a_blind_channel_with_it() {
    let mut bench = Bench::running(2, 60_000, 50);
    bench.attach(2, 60e3);
    bench.ticks(45);
    bench.code[1] = Some(0);
    bench.ticks(1_950);
    let held_pa = bench.fixtures[0].gauge_pa();
    assert!((held_pa - 60e3).abs() < 1.5e3, "kept while holding: {held_pa}");
    for _ in 0..1_500 {
        bench.tick();
    }
    for fixture in &bench.fixtures {
        let pressure_pa = fixture.gauge_pa();
        assert!((20e3..45e3).contains(&pressure_pa), "1.45 s at 20 kPa/s from 60 kPa: {pressure_pa}");
    }
    bench.ticks(5_000);
    assert!(bench.fixtures.iter().all(|fixture| fixture.gauge_pa() < 2e3));
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
}

#[test]
fn fault_keeps_the_pressure_without_limit_where_the_policy_is_to_hold() {
    let mut bench = Bench::new();
    bench.hello();
    let system = ConfigSystem { link_loss_policy: LinkLossPolicy::Hold.into(), ..crate::common::system() };
    bench.configure(&system, &crate::common::channels(&[SetpointKind::Pressure]));
    bench.ticks(550);
    bench.supply_pa = 231e3;
    bench.ticks_until(DeviceState::Faulted, 20);
    bench.pressure_pa[0] = 60e3;
    for _ in 0..10_000 {
        assert_eq!(bench.tick().valves[0], ValvePulse::CLOSED);
    }
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
}

#[test]
fn stop_needs_no_session_and_no_configuration() {
    let mut bench = Bench::new();
    let stop = Command { session: SESSION, code: CommandCode::EmergencyStop.into(), time_us: 0 };
    assert_eq!(bench.request(&stop.into()).result, ResultCode::Ok);
    assert_eq!(bench.tick().valves, [ValvePulse::VENTING; MAX_CHANNELS]);
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
}

#[test]
fn low_supply_is_a_fault_after_a_tenth_of_a_second_and_only_while_running() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure]);
    bench.supply_pa = 100e3;
    bench.ticks(500);
    assert_eq!(bench.controller.state(), DeviceState::Ready);
    let mut bench = Bench::running(1, 50_000, 50);
    bench.supply_pa = 149e3;
    bench.ticks(99);
    assert_eq!(bench.controller.state(), DeviceState::Running);
    let outputs = bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
    assert_eq!(only_fault(&bench), (FaultCode::SupplyLow, SYSTEM_CHANNEL));
    assert!(outputs.pump_duty == 255 && outputs.supply_open, "the supply may recover");
}

/// Start of a device that is ready and has a knot to follow.
fn start(bench: &mut Bench) -> Ack {
    assert_eq!(bench.setpoint(0, bench.now_us + 1_000_000, &[0]).result, ResultCode::Ok);
    bench.command(CommandCode::Start)
}

#[test]
fn low_voltage_of_the_valves_is_a_fault_after_five_ticks_and_lasts() {
    let mut bench = Bench::running(1, 50_000, 50);
    bench.valve_supply_v = 20.01;
    bench.ticks(20);
    bench.valve_supply_v = 19.99;
    bench.ticks(4);
    bench.valve_supply_v = 24.0;
    bench.ticks(20);
    assert_eq!(bench.controller.state(), DeviceState::Running, "a dip of four ticks is none");
    bench.valve_supply_v = 19.99;
    bench.ticks(4);
    assert_eq!(bench.controller.state(), DeviceState::Running);
    let outputs = bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
    assert_eq!(only_fault(&bench), (FaultCode::ValveSupplyLow, SYSTEM_CHANNEL));
    assert!(!outputs.supply_open && outputs.pump_duty == 0);
    assert_eq!(outputs.valves[0], ValvePulse::CLOSED);
    let values = bench.messages.iter().filter_map(|message| match message {
        DeviceMessage::Fault(fault) => Some(fault.value),
        _ => None,
    });
    assert_eq!(values.collect::<Vec<_>>(), [19_989]);
    bench.ticks(20);
    let refused = bench.command(CommandCode::ClearFaults);
    let wanted = (ResultCode::WrongState.into(), FaultCode::ValveSupplyLow as u32);
    assert_eq!((refused.result, refused.detail), wanted);
    bench.valve_supply_v = 24.0;
    bench.ticks(100);
    assert!(bench.controller.faults().contains(FaultCode::ValveSupplyLow), "latched");
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
    assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
    assert_eq!(bench.controller.faults().bits(), 0);
}

#[test]
fn low_voltage_of_the_valves_forbids_start_before_it_is_a_fault() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure]);
    bench.valve_supply_v = 19.0;
    bench.tick();
    assert_eq!((bench.controller.state(), bench.controller.faults().bits()), (DeviceState::Ready, 0));
    let refused = start(&mut bench);
    let wanted = (ResultCode::WrongState.into(), FaultCode::ValveSupplyLow as u32);
    assert_eq!((refused.result, refused.detail), wanted);
    bench.valve_supply_v = 20.1;
    bench.tick();
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
    let mut bench = Bench::ready(&[SetpointKind::Pressure]);
    bench.valve_supply_v = 19.0;
    bench.ticks(5);
    assert_eq!(only_fault(&bench), (FaultCode::ValveSupplyLow, SYSTEM_CHANNEL));
}

#[test]
fn zeros_wait_for_the_voltage_of_the_vents() {
    let mut bench = Bench::new();
    bench.hello();
    bench.valve_supply_v = 0.0;
    bench.configure(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure]));
    bench.ticks(2_000);
    assert_eq!(bench.controller.state(), DeviceState::Idle);
    let refused = bench.command(CommandCode::ClearFaults);
    assert_eq!(refused.detail, FaultCode::ValveSupplyLow as u32);
    assert_eq!(only_fault(&bench), (FaultCode::ValveSupplyLow, SYSTEM_CHANNEL));
    bench.valve_supply_v = 24.0;
    assert!(bench.ticks_until(DeviceState::Ready, 1_100) > 500, "two means");
    assert_eq!(start(&mut bench).detail, FaultCode::ValveSupplyLow as u32, "latched");
    assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
}

#[test]
fn holding_and_venting_need_the_voltage_and_a_stop_keeps_its_name() {
    for command in [CommandCode::Hold, CommandCode::Vent] {
        let mut bench = Bench::running(1, 50_000, 50);
        assert_eq!(bench.command(command).result, ResultCode::Ok);
        bench.ticks(10);
        bench.valve_supply_v = 5.0;
        bench.ticks(5);
        assert_eq!(bench.controller.state(), DeviceState::Faulted, "{command:?}");
        assert_eq!(only_fault(&bench), (FaultCode::ValveSupplyLow, SYSTEM_CHANNEL), "{command:?}");
    }
    let mut bench = Bench::running(1, 50_000, 50);
    (bench.emergency_stop, bench.valve_supply_v) = (true, 0.0);
    bench.ticks(100);
    assert_eq!(only_fault(&bench), (FaultCode::EmergencyStop, SYSTEM_CHANNEL));
}

#[test]
fn voltage_that_is_not_watched_is_told_and_no_fault_and_one_that_is_not_sensed_is_none() {
    for (full_scale_mv, told_mv) in [(36_300, 17), (0, u16::MAX)] {
        let system =
            ConfigSystem { valve_supply_scale_mv: full_scale_mv, valve_supply_min_mv: 0, ..crate::common::system() };
        let mut bench = Bench::new();
        bench.hello();
        bench.valve_supply_v = 0.02;
        bench.configure(&system, &crate::common::channels(&[SetpointKind::Pressure]));
        bench.ticks(550);
        assert_eq!(start(&mut bench).result, ResultCode::Ok);
        bench.ticks(500);
        assert_eq!((bench.controller.state(), bench.controller.faults().bits()), (DeviceState::Running, 0));
        let told = bench.messages.iter().rev().find_map(|message| match message {
            DeviceMessage::Telemetry(telemetry) => Some(telemetry.valve_supply_mv),
            _ => None,
        });
        assert_eq!(told, Some(told_mv));
    }
}

#[test]
fn high_supply_stops_the_pump_before_the_limit_and_is_cut_above_it() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure]);
    let mut duty = |supply_pa: f64| {
        bench.supply_pa = supply_pa;
        bench.tick().pump_duty
    };
    assert_eq!(duty(150e3), 255);
    assert!((1..255).contains(&duty(218e3)));
    assert_eq!(duty(223e3), 0);
    bench.supply_pa = 231e3;
    bench.code = [None; MAX_CHANNELS];
    bench.ticks(9);
    assert_eq!(bench.controller.state(), DeviceState::Ready);
    let outputs = bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
    assert!(!outputs.supply_open);
    assert_eq!(only_fault(&bench), (FaultCode::SupplyHigh, SYSTEM_CHANNEL));
}

#[test]
fn stop_command_is_honoured_from_any_session_and_takes_one_tick() {
    let mut bench = Bench::running(2, 50_000, 50);
    let stop = Command { session: SESSION + 1, code: CommandCode::EmergencyStop.into(), time_us: 0 };
    assert_eq!(bench.request(&stop.into()).result, ResultCode::Ok);
    let outputs = bench.tick();
    assert_eq!(outputs.valves[..2], [ValvePulse::VENTING; 2]);
    assert_eq!(only_fault(&bench), (FaultCode::EmergencyStop, SYSTEM_CHANNEL));
}

#[test]
fn deformation_that_no_pressure_reaches_keeps_the_last_pressure_and_then_faults() {
    let channel = ConfigChannel { setpoint_max: 60_000_000, ..crate::common::straight(0) };
    let mut bench = Bench::new();
    bench.hello();
    bench.configure(&crate::common::system(), &[channel]);
    bench.attach(1, 0.0);
    bench.ticks(550);
    let first_us = bench.now_us + 20_000;
    // No wall of 5 mm is left of it at a stretch of 50.
    for (index, value) in [1_020_000, 1_020_000, 1_020_000, 50_000_000, 50_000_000].into_iter().enumerate() {
        let ack = bench.setpoint(index as u32, first_us + index as u64 * 200_000, &[value]);
        assert_eq!(ack.result, ResultCode::Ok);
    }
    bench.command(CommandCode::Start);
    bench.ticks(380);
    let before_pa = bench.controller.channel(0).unwrap().reference_pa(bench.now_us).unwrap();
    assert!(before_pa > 1e3, "{before_pa}");
    bench.ticks_until(DeviceState::Faulted, 300);
    assert_eq!(only_fault(&bench), (FaultCode::InverseFailed, 0));
}

#[test]
fn two_late_ticks_within_a_second_are_a_fault_while_running() {
    let mut bench = Bench::running(1, 50_000, 50);
    bench.ticks(10);
    bench.now_us += 1_000;
    bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Running);
    bench.ticks(100);
    bench.now_us += 1_000;
    bench.tick();
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
    assert_eq!(only_fault(&bench), (FaultCode::TickOverrun, SYSTEM_CHANNEL));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, rng_seed: RngSeed::Fixed(2026), ..ProptestConfig::default() })]

    #[test]
    fn outputs_stay_sane_for_any_converters_and_clock(
        steps in proptest::collection::vec((any::<u16>(), 0_usize..3, any::<f64>(), 0_u64..5_000_000_000, any::<bool>()), 1..80),
    ) {
        let mut bench = Bench::running(2, 50_000, 60);
        for (code, channel, supply_pa, jump_us, stop) in steps {
            bench.code[channel] = Some(code);
            bench.supply_pa = if supply_pa.is_finite() { supply_pa } else { 0.0 };
            bench.emergency_stop = stop && code % 64 == 0;
            if code % 16 == 0 {
                bench.now_us += jump_us;
            }
            // The bench itself checks that no two coils of a channel are energized at once.
            let outputs = bench.tick();
            if bench.controller.faults().cuts_supply() {
                prop_assert!(!outputs.supply_open && outputs.pump_duty == 0);
            }
            if bench.controller.state() != DeviceState::Running {
                prop_assert!(outputs.valves.iter().all(|pulse| pulse.fill_us == 0), "nothing fills by itself");
            }
        }
    }
}
