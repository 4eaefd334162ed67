//! The log of a device, from a fault over a crash to the host that connects anew.

use softlimb_protocol::{BootCause, FaultCode, LogCondition};
use softlimb_rig::link::{DeviceLog, LinkError, StreamOptions, read_log};
use softlimb_sim::{LineFaults, Processor, SimulatedMcu, here};

use crate::link_common::{SESSION, device, settings};

fn session(number: u16) -> StreamOptions<'static> {
    StreamOptions { occupied_max_us: 500_000, ..StreamOptions::new(SESSION + number) }
}

/// Lets the device go on for a time.
fn pass(mcu: &mut SimulatedMcu, time_us: u64) {
    mcu.advance_to(mcu.now_us() + time_us);
}

/// Number and cause of each start in the log, and the codes of its faults.
fn content(log: &DeviceLog) -> Vec<(u32, Option<BootCause>, Vec<FaultCode>)> {
    let starts = log.starts.iter().map(|start| {
        let codes = start.faults.iter().map(|fault| fault.code.known().unwrap()).collect();
        (start.number, start.cause.map(|cause| cause.cause.known().unwrap()), codes)
    });
    starts.collect()
}

#[test]
fn fault_before_a_crash_is_in_the_log_after_it_and_after_power_was_off() {
    let mut mcu = device(&settings(2));
    pass(&mut mcu, 20_000);
    let log = read_log(&mut mcu, &session(0)).unwrap();
    assert_eq!(content(&log), [(1, Some(BootCause::PowerOn), vec![])]);
    assert_eq!((log.condition.known(), log.unstored), (Some(LogCondition::Kept), 0));

    let stopped_us = mcu.device_time_us();
    mcu.set_emergency_stop(true);
    pass(&mut mcu, 20_000);
    mcu.set_emergency_stop(false);
    mcu.processor_mut().crash().unwrap();
    pass(&mut mcu, 200_000);
    let log = read_log(&mut mcu, &session(1)).unwrap();
    let expected =
        [(1, Some(BootCause::PowerOn), vec![FaultCode::EmergencyStop]), (2, Some(BootCause::HardFault), vec![])];
    assert_eq!(content(&log), expected);
    let fault = log.starts[0].faults[0];
    assert!(fault.time_us.unwrap().abs_diff(stopped_us) <= 1_000 && fault.channel.is_none(), "{fault:?}");

    *mcu.processor_mut() = here();
    pass(&mut mcu, 200_000);
    let log = read_log(&mut mcu, &session(2)).unwrap();
    assert_eq!(content(&log), [&expected[..], &[(3, Some(BootCause::PowerOn), vec![])]].concat());
}

#[test]
fn crash_within_a_record_spoils_that_record_alone() {
    // A record takes seven turns after the tick of its fault.
    for turns in 0..=8 {
        let mut mcu = device(&settings(1));
        pass(&mut mcu, 20_000);
        mcu.set_emergency_stop(true);
        pass(&mut mcu, 1_000 * turns);
        mcu.set_emergency_stop(false);
        mcu.processor_mut().crash().unwrap();
        pass(&mut mcu, 200_000);
        let log = read_log(&mut mcu, &session(0)).unwrap();
        let faults = if turns < 7 { vec![] } else { vec![FaultCode::EmergencyStop] };
        let expected = [(1, Some(BootCause::PowerOn), faults), (2, Some(BootCause::HardFault), vec![])];
        assert_eq!(content(&log), expected, "crash after {turns} turns");
        assert_eq!(log.condition, LogCondition::Kept);
    }
}

#[test]
fn long_log_comes_whole_over_a_bad_line() {
    let mut mcu = device(&settings(1));
    for _ in 0..100 {
        pass(&mut mcu, 10_000);
        mcu.processor_mut().crash().unwrap();
    }
    pass(&mut mcu, 200_000);
    mcu.set_line_faults(LineFaults { drop: 1e-3, flip: 1e-3, duplicate: 1e-3 }).unwrap();
    let log = read_log(&mut mcu, &session(0)).unwrap();
    let mut expected = vec![(1, Some(BootCause::PowerOn), vec![])];
    expected.extend((2..=101).map(|number| (number, Some(BootCause::HardFault), vec![])));
    assert_eq!(content(&log), expected);
}

#[test]
fn log_is_for_the_host_that_commands() {
    let mut mcu = device(&settings(1));
    pass(&mut mcu, 20_000);
    read_log(&mut mcu, &session(0)).unwrap();
    let at_once = StreamOptions { occupied_max_us: 0, ..session(1) };
    assert!(matches!(read_log(&mut mcu, &at_once), Err(LinkError::Occupied)));
}
