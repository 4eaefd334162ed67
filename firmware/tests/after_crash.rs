//! A device that starts after a crash of its program empties the limb before it takes part in anything.

use crate::common::{Bench, SESSION};
use softlimb_firmware::{BootInfo, Controller, TickOutputs};
use softlimb_protocol::*;

/// For how long the vents are open, ticks: the longest that any venting takes.
const OPEN_TICKS: usize = 5_000;

fn started(cause: BootCause) -> Bench {
    let mut bench = Bench::new();
    bench.controller = Controller::new(BootInfo { cause, detail: 7 });
    bench
}

#[test]
fn all_vents_are_open_from_the_first_tick_for_five_seconds_whatever_the_clock_shows() {
    for cause in
        [BootCause::Panic, BootCause::HardFault, BootCause::Watchdog, BootCause::ClockFailure, BootCause::ImageDamaged]
    {
        for began_us in [0, 1_000, 1 << 40] {
            let mut bench = started(cause);
            bench.now_us = began_us;
            for tick in 0..OPEN_TICKS {
                assert_eq!(bench.tick(), TickOutputs::VENTING, "{cause:?}, tick {tick}");
            }
            assert_eq!(bench.tick(), TickOutputs::SAFE, "{cause:?}");
            assert_eq!(bench.controller.state(), DeviceState::Idle, "{cause:?}");
            assert_eq!(bench.told_faults(), [], "{cause:?}: what vents is no fault");
        }
    }
}

#[test]
fn after_any_other_start_nothing_moves() {
    for cause in [BootCause::PowerOn, BootCause::ResetPin, BootCause::Software, BootCause::BrownOut] {
        let mut bench = started(cause);
        assert_eq!(bench.controller.state(), DeviceState::Idle, "{cause:?}");
        for _ in 0..100 {
            assert_eq!(bench.tick(), TickOutputs::SAFE, "{cause:?}");
        }
    }
}

#[test]
fn reason_that_is_told_later_does_the_same() {
    for cause in (0..=255).filter_map(BootCause::from_code) {
        let boot = BootInfo { cause, detail: 7 };
        let mut later = Bench::new();
        later.controller.set_boot(boot);
        let mut at_once = started(cause);
        for _ in 0..OPEN_TICKS + 10 {
            assert_eq!(later.tick(), at_once.tick(), "{cause:?}");
        }
    }
}

#[test]
fn air_leaves_after_a_crash_whatever_the_host_sends_and_the_device_is_ready_only_after() {
    let mut bench = started(BootCause::Panic);
    bench.ticks(10);
    bench.hello();
    let told = bench.messages.iter().find_map(|message| match message {
        DeviceMessage::HelloReply(reply) => Some((reply.boot_cause.known(), reply.boot_detail, reply.state.known())),
        _ => None,
    });
    assert_eq!(told, Some((Some(BootCause::Panic), 7, Some(DeviceState::Venting))));
    let upload = crate::common::upload(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure]));
    for message in &upload {
        let wanted =
            if matches!(message, HostMessage::ConfigCommit(_)) { ResultCode::WrongState } else { ResultCode::Ok };
        assert_eq!(bench.request(message).result, wanted, "{message:?}");
    }
    for code in [CommandCode::Start, CommandCode::Hold, CommandCode::Vent] {
        assert_eq!(bench.command(code).result, ResultCode::WrongState, "{code:?}");
    }
    assert_eq!(bench.setpoint(0, bench.now_us + 9_000_000, &[0]).result, ResultCode::WrongState);
    assert_eq!(bench.command(CommandCode::ClearFaults).result, ResultCode::Ok);
    assert_eq!(bench.command(CommandCode::Flush).result, ResultCode::Ok);
    for tick in 10..OPEN_TICKS {
        assert_eq!(bench.tick(), TickOutputs::VENTING, "tick {tick}");
    }
    assert_eq!(bench.tick(), TickOutputs::SAFE);
    bench.configure(&crate::common::system(), &crate::common::channels(&[SetpointKind::Pressure]));
    bench.ticks(550);
    assert_eq!(bench.controller.state(), DeviceState::Ready);
}

#[test]
fn emergency_stop_meanwhile_keeps_the_vents_open() {
    let mut bench = started(BootCause::HardFault);
    bench.ticks(10);
    let stop = Command { session: SESSION + 5, code: CommandCode::EmergencyStop.into(), time_us: 0 };
    assert_eq!(bench.request(&stop.into()).result, ResultCode::Ok);
    for tick in 0..2 * OPEN_TICKS {
        assert_eq!(bench.tick(), TickOutputs::VENTING, "tick {tick}");
    }
    assert_eq!(bench.controller.state(), DeviceState::Faulted);
}
