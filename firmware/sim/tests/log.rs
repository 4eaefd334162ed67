//! The log beside a run: while the limb follows setpoints it neither takes time nor answers.

use softlimb_protocol::*;

use crate::common::{Host, SESSION, settings};

/// All records, and the last state of the log.
fn log(host: &mut Host) -> (Vec<LogRecord>, LogState) {
    let before = host.heard.len();
    host.demand(ReadLog { session: SESSION, first: 0 });
    let (mut records, mut last) = (Vec::new(), None);
    for (_, message) in &host.heard[before..] {
        match message {
            DeviceMessage::LogRecords(page) => records.extend(page.records.iter()),
            DeviceMessage::LogState(state) => last = Some(state.clone()),
            _ => {}
        }
    }
    (records, last.expect("a LogState"))
}

fn state(host: &Host) -> Option<DeviceState> {
    host.telemetry().last()?.state.known()
}

/// A device that follows setpoints for a second.
fn running() -> Host {
    let mut host = Host::new(&settings(1));
    host.get_ready(1, SetpointKind::Pressure);
    let start_us = host.telemetry().last().expect("telemetry").time_us + 100_000;
    for index in 0..20 {
        host.setpoint(index, start_us + 50_000 * u64::from(index), &[30_000]);
        host.wait(1_000);
    }
    host.demand(Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us });
    host.wait(150_000);
    assert_eq!(state(&host), Some(DeviceState::Running));
    host
}

#[test]
fn link_that_is_lost_in_a_run_is_in_the_log_after_it() {
    let mut host = running();
    assert_eq!(host.ask(ReadLog { session: SESSION, first: 0 }), Some(ResultCode::WrongState));
    // Longer than the timeout: the device goes on to its last setpoint.
    host.wait(600_000);
    assert_eq!(state(&host), Some(DeviceState::Running));
    host.wait(700_000);
    assert_eq!(state(&host), Some(DeviceState::Holding));
    let (records, state) = log(&mut host);
    let lost_us = host.heard.iter().find_map(|(_, message)| match message {
        DeviceMessage::Fault(fault) if fault.code == FaultCode::LinkLost => Some((fault.time_us, fault.value)),
        _ => None,
    });
    let [boot, lost] = &records[..] else { panic!("{records:?}") };
    assert_eq!((boot.kind.known(), boot.start, boot.time_us), (Some(LogKind::Boot), 1, 0));
    assert_eq!((lost.kind.known(), lost.code), (Some(LogKind::Fault), FaultCode::LinkLost as u8));
    assert_eq!((lost.start, lost.channel, Some((lost.time_us, lost.detail as i32))), (1, SYSTEM_CHANNEL, lost_us));
    assert_eq!((state.condition.known(), state.unstored, state.records), (Some(LogCondition::Kept), 0, 2));
    assert_eq!((state.next, state.until), (lost.number + 1, lost.number + 1));
}

#[test]
fn record_waits_while_the_limb_follows_setpoints() {
    // The silence of the link becomes a fault after 0.2 s. A crash 0.3 s later finds the record still waiting: no turn of the run programmed it.
    let mut host = running();
    host.wait(500_000);
    assert_eq!(state(&host), Some(DeviceState::Running));
    let lost =
        |message: &DeviceMessage| matches!(message, DeviceMessage::Fault(fault) if fault.code == FaultCode::LinkLost);
    assert!(host.heard.iter().any(|(_, message)| lost(message)));
    softlimb_sim::Processor::crash(host.mcu.processor_mut()).expect("it stops");
    host.wait(100_000);
    host.demand(Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION });
    let (records, _) = log(&mut host);
    let found: Vec<_> = records.iter().map(|record| (record.kind.known(), record.start, record.code)).collect();
    let boot = |start, cause: BootCause| (Some(LogKind::Boot), start, cause as u8);
    assert_eq!(found, [boot(1, BootCause::PowerOn), boot(2, BootCause::HardFault)]);
}
