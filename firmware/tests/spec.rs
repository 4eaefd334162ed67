//! `protocol/SPEC.md` says what the firmware does: its tables of states, commands and faults are held against the device.

use crate::common::spec::table;
use crate::common::{Bench, SESSION};
use softlimb_firmware::{Event, Faults, Occurrence, TRANSITIONS, VentScope, reaction};
use softlimb_protocol::DeviceState::{Faulted, Holding, Idle, Ready, Running, Venting};
use softlimb_protocol::*;

#[test]
fn table_of_states_is_the_firmwares() {
    let written: Vec<_> = table(["From", "Event", "To"]).iter().map(|row| row.join(" ")).collect();
    let built: Vec<_> = TRANSITIONS.iter().map(|(from, event, to)| format!("{from:?} {event:?} {to:?}")).collect();
    assert_eq!(written, built);
}

#[test]
fn every_event_is_explained() {
    let explained: Vec<_> = table(["Event", "Is"]).into_iter().map(|[event, _]| event).collect();
    let mut used: Vec<Event> = Vec::new();
    for &(_, event, _) in TRANSITIONS {
        if !used.contains(&event) {
            used.push(event);
        }
    }
    let mut used: Vec<_> = used.iter().map(|event| format!("{event:?}")).collect();
    let mut sorted = explained.clone();
    sorted.sort();
    used.sort();
    assert_eq!(sorted, used);
}

/// All faults, by their codes.
fn fault_codes() -> Vec<FaultCode> {
    (0..=255).filter_map(FaultCode::from_code).collect()
}

#[test]
fn table_of_faults_is_the_firmwares() {
    let yes = |answer: bool| String::from(if answer { "yes" } else { "no" });
    let built: Vec<_> = fault_codes()
        .into_iter()
        .map(|code| {
            let reaction = reaction(code);
            let vents = match reaction.vents {
                VentScope::Nothing => "none",
                VentScope::Channel => "channel",
                VentScope::All => "all",
            };
            let mut faults = Faults::new();
            faults.raise(Occurrence::system(0, code, 0));
            let forbids = faults.blocks_start() == Some(code);
            [format!("{code:?}"), yes(reaction.latches), yes(reaction.cuts_supply), vents.into(), yes(forbids)]
        })
        .collect();
    let written = table(["Fault", "Enters Faulted", "Cuts supply", "Vents at once", "Forbids Start"]);
    assert_eq!(written, built);
}

#[test]
fn every_fault_has_its_cause() {
    let mut explained: Vec<_> =
        table(["Fault", "Raised when", "Channel", "value"]).into_iter().map(|[fault, ..]| fault).collect();
    explained.dedup();
    let faults: Vec<_> = fault_codes().iter().map(|code| format!("{code:?}")).collect();
    assert_eq!(explained, faults);
}

/// A configured device in a state, with what a message may need: buffered knots where they are accepted, no fault that stands.
fn device_in(state: DeviceState) -> Bench {
    let mut bench = match state {
        Idle => {
            let mut bench = Bench::new();
            bench.hello();
            bench.code[0] = Some(0);
            bench.configure(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure]));
            bench.ticks(50);
            bench
        }
        Ready => Bench::ready(&[SetpointKind::Pressure]),
        _ => Bench::running(1, 40_000, 60),
    };
    bench.pressure_pa[0] = if state == Ready { 0.0 } else { 40e3 };
    match state {
        Holding => assert_eq!(bench.command(CommandCode::Hold).result, ResultCode::Ok),
        Venting => assert_eq!(bench.command(CommandCode::Vent).result, ResultCode::Ok),
        Faulted => {
            bench.emergency_stop = true;
            bench.tick();
            bench.emergency_stop = false;
            bench.tick();
        }
        _ => {}
    }
    if matches!(state, Ready | Holding) {
        assert_eq!(bench.command(CommandCode::Flush).result, ResultCode::Ok);
        assert_eq!(bench.setpoint(0, bench.now_us + 5_000_000, &[40_000]).result, ResultCode::Ok);
    }
    assert_eq!(bench.controller.state(), state);
    bench
}

/// Whether the device takes a message, named as in the specification.
fn takes(bench: &mut Bench, name: &str) -> bool {
    let parts = crate::common::upload(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure]));
    let command = |code: CommandCode| Command { session: SESSION, code: code.into(), time_us: 0 }.into();
    let next_knot = Setpoint {
        session: SESSION,
        index: bench.controller.queue().next_index(),
        time_us: bench.now_us + 9_000_000,
        outputs: Outputs::GRIPPER,
        values: List::from_slice(&[40_000]).unwrap(),
    };
    let messages = match name {
        "ConfigBegin, ConfigSystem, ConfigChannel" => parts[..3].to_vec(),
        "ConfigCommit" => parts,
        "Setpoint" => vec![next_knot.into()],
        "Knots" => {
            let step = KnotStep { step_us: 60_000, outputs: Outputs::GRIPPER, steps: List::from_slice(&[0]).unwrap() };
            let mut knots = Batch::new();
            knots.push(&step).unwrap();
            vec![Knots { session: SESSION, index: next_knot.index, knots }.into()]
        }
        "SetSampling" => vec![
            SetSampling { session: SESSION, period_us: 5_000, samples: 1, content: SampleContent::Measurements.into() }
                .into(),
        ],
        "ReadLog" => vec![ReadLog { session: SESSION, first: 0 }.into()],
        "ReadLinkErrors" => vec![ReadLinkErrors { session: SESSION }.into()],
        "Start" => vec![command(CommandCode::Start)],
        "Hold" => vec![command(CommandCode::Hold)],
        "Vent" => vec![command(CommandCode::Vent)],
        "EmergencyStop" => vec![command(CommandCode::EmergencyStop)],
        "ClearFaults" => {
            // No cause of a fault is there any more.
            bench.code[0] = None;
            bench.ticks(3);
            vec![command(CommandCode::ClearFaults)]
        }
        "Flush" => vec![command(CommandCode::Flush)],
        "Zero" => vec![command(CommandCode::Zero)],
        "ManualPulse" => {
            let direction = PulseDirection::Fill.into();
            vec![ManualPulse { session: SESSION, channel: 0, direction, duration_us: 20_000 }.into()]
        }
        "SetOutputs" => vec![SetOutputs { session: SESSION, outputs: Outputs::GRIPPER }.into()],
        other => panic!("no message {other}"),
    };
    let results: Vec<_> = messages.iter().map(|message| bench.request(message).result).collect();
    let (last, before) = results.split_last().unwrap();
    assert!(before.iter().all(|&result| result == ResultCode::Ok), "{name}: {results:?}");
    assert!(*last == ResultCode::Ok || *last == ResultCode::WrongState, "{name}: {last:?}");
    *last == ResultCode::Ok
}

#[test]
fn table_of_messages_by_state_is_the_firmwares() {
    let states = [Idle, Ready, Running, Holding, Venting, Faulted];
    let rows = table(["Message", "Idle", "Ready", "Running", "Holding", "Venting", "Faulted"]);
    let codes = (0..=255).filter_map(CommandCode::from_code).count();
    assert_eq!(
        rows.len(),
        codes + 9,
        "all commands, the upload, its commit, setpoint and knots, pulse and outputs by hand, sampling, link errors, log"
    );
    for row in rows {
        let (name, answers) = row.split_first().unwrap();
        for (state, written) in states.into_iter().zip(answers) {
            let answer = if takes(&mut device_in(state), name) { "yes" } else { "no" };
            assert_eq!(written, answer, "{name} while {state:?}");
        }
    }
}

#[test]
fn setpoint_is_checked_in_the_order_of_the_table() {
    let rows = table(["Refused with", "When", "detail"]);
    let written: Vec<_> = rows.iter().map(|[result, ..]| result.as_str()).collect();
    let mut idle = Bench::new();
    idle.hello();
    let mut bench = Bench::ready(&[SetpointKind::Pressure; 2]);
    for index in 0..64 {
        bench.setpoint(index, bench.now_us + 1_000_000 + u64::from(index), &[0, 0]);
    }
    // Each knot has one fault less than the one before; the buffer is full for all.
    let (unknown, known) = (Outputs::from_bits(0x80), Outputs::GRIPPER);
    let mut answers = vec![idle.knot(999, 0, unknown, &[-1])];
    let far_us = bench.now_us + 60_000_001;
    for (index, time_us, outputs, values) in [
        (999, far_us, unknown, &[-1][..]),
        (999, far_us, unknown, &[0, -1]),
        (999, far_us, unknown, &[0, 0]),
        (999, far_us, known, &[0, 150_000]),
        (64, far_us, known, &[0, 150_000]),
        (64, bench.now_us + 1_000_064, known, &[0, 150_000]),
        (64, 0, known, &[0, 0]),
    ] {
        answers.push(bench.knot(index, time_us, outputs, values));
    }
    bench.command(CommandCode::Flush);
    answers.push(bench.setpoint(0, bench.now_us, &[0, 0]));
    let found: Vec<_> = answers.iter().map(|ack| format!("{} {:?}", ack.result.raw(), ack.result)).collect();
    assert_eq!(written, found);
    assert_eq!(answers.iter().map(|ack| ack.detail).collect::<Vec<_>>(), [0, 2, 1, 3, 64, 60_000_000, 1, 0, 0]);
}
