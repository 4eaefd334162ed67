//! Digital outputs: what switches them, and what does not.

use crate::common::{Bench, SESSION};
use softlimb_firmware::{BootInfo, Controller, TICK_US};
use softlimb_protocol::*;

const OFF: Outputs = Outputs::from_bits(0);
const PRESSURE: [SetpointKind; 1] = [SetpointKind::Pressure];

/// A device that holds, its limb under pressure and its gripper closed by hand.
fn gripping() -> Bench {
    let mut bench = Bench::running(1, 40_000, 60);
    bench.pressure_pa[0] = 40e3;
    assert_eq!(bench.command(CommandCode::Hold).result, ResultCode::Ok);
    assert_eq!(bench.set_outputs(Outputs::GRIPPER).result, ResultCode::Ok);
    assert_eq!(bench.tick().digital, Outputs::GRIPPER);
    bench
}

#[test]
fn output_switches_at_the_tick_that_passes_its_knot() {
    let mut bench = Bench::ready(&PRESSURE);
    bench.attach(1, 0.0);
    let first_us = bench.now_us + 50_000;
    let knots =
        [(0, OFF), (20_000, OFF), (40_000, Outputs::GRIPPER), (60_500, Outputs::GRIPPER), (80_000, OFF), (90_000, OFF)];
    for (index, (after_us, outputs)) in (0..).zip(knots) {
        assert_eq!(bench.knot(index, first_us + after_us, outputs, &[40_000]).result, ResultCode::Ok);
    }
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
    let mut switched = Vec::new();
    let mut before = OFF;
    while bench.now_us < first_us + 100_000 {
        let now_us = bench.now_us;
        let digital = bench.tick().digital;
        if digital != before {
            switched.push((now_us - first_us, digital));
            before = digital;
        }
    }
    assert_eq!(switched, [(40_000, Outputs::GRIPPER), (80_000, OFF)]);
}

#[test]
fn knot_between_two_ticks_switches_at_the_later_one() {
    let mut bench = Bench::ready(&PRESSURE);
    let at_us = bench.now_us + 50_300;
    bench.knot(0, at_us, Outputs::GRIPPER, &[0]);
    bench.knot(1, at_us + 20_000, Outputs::GRIPPER, &[0]);
    bench.command(CommandCode::Start);
    while bench.tick().digital == OFF {}
    let began_us = bench.now_us - u64::from(TICK_US);
    assert!(began_us >= at_us && began_us < at_us + u64::from(TICK_US), "{began_us} {at_us}");
}

#[test]
fn no_state_and_no_fault_lets_go_of_the_payload() {
    type Cause = fn(&mut Bench);
    let causes: [(&str, DeviceState, Cause); 5] = [
        ("command to vent", DeviceState::Venting, |bench| {
            bench.command(CommandCode::Vent);
        }),
        ("emergency stop", DeviceState::Faulted, |bench| bench.emergency_stop = true),
        ("over-pressure", DeviceState::Faulted, |bench| bench.pressure_pa[0] = 160e3),
        ("broken sensor", DeviceState::Faulted, |bench| bench.code[0] = Some(0)),
        ("lost link", DeviceState::Venting, |bench| bench.heartbeats = false),
    ];
    for (name, state, cause) in causes {
        let mut bench = gripping();
        cause(&mut bench);
        bench.ticks_until(state, 3_000);
        for _ in 0..3_000 {
            assert_eq!(bench.tick().digital, Outputs::GRIPPER, "{name}");
        }
    }
}

#[test]
fn output_stays_through_venting_a_new_session_and_a_new_configuration() {
    let mut bench = gripping();
    bench.command(CommandCode::Vent);
    bench.pressure_pa[0] = 0.0;
    bench.ticks_until(DeviceState::Ready, 10_000);
    bench.hello();
    bench.configure(&crate::common::system(), &crate::common::channels(&PRESSURE));
    assert_eq!(bench.controller.state(), DeviceState::Idle);
    bench.ticks_until(DeviceState::Ready, 600);
    assert_eq!(bench.tick().digital, Outputs::GRIPPER);
    assert_eq!(bench.set_outputs(OFF).result, ResultCode::Ok);
    assert_eq!(bench.tick().digital, OFF);
}

#[test]
fn outputs_are_off_after_every_start() {
    for cause in (0..=255).filter_map(BootCause::from_code) {
        let mut bench = gripping();
        bench.controller = Controller::new(BootInfo { cause, detail: 0 });
        for _ in 0..100 {
            assert_eq!(bench.tick().digital, OFF, "{cause:?}");
        }
    }
}

#[test]
fn telemetry_tells_the_present_state() {
    let mut bench = gripping();
    bench.ticks(20);
    let told = |bench: &Bench| {
        bench.messages.iter().rev().find_map(|message| match message {
            DeviceMessage::Telemetry(telemetry) => Some(telemetry.outputs),
            _ => None,
        })
    };
    assert_eq!(told(&bench), Some(Outputs::GRIPPER));
    bench.set_outputs(OFF);
    bench.ticks(20);
    assert_eq!(told(&bench), Some(OFF));
}

#[test]
fn output_that_the_device_does_not_have_is_refused_and_changes_nothing() {
    let mut bench = gripping();
    let ack = bench.set_outputs(Outputs::from_bits(0b11));
    assert_eq!((ack.result, ack.detail), (ResultCode::UnknownCode.into(), 1));
    assert_eq!(bench.tick().digital, Outputs::GRIPPER);
    let request = SetOutputs { session: SESSION ^ 1, outputs: OFF }.into();
    assert_eq!(bench.request(&request).result, ResultCode::WrongSession);
    assert_eq!(bench.tick().digital, Outputs::GRIPPER);
}
