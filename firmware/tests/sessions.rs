//! Who commands the device: one host at a time, which speaks the same interface.

use crate::common::{Bench, SESSION, system};
use softlimb_protocol::*;

#[test]
fn second_host_can_read_but_not_command() {
    let mut bench = Bench::running(1, 50_000, 50);
    let other = SESSION + 1;
    let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: other };
    assert_eq!(bench.request(&hello.into()).result, ResultCode::WrongSession);
    let told = |wanted: fn(&DeviceMessage) -> bool| bench.messages.iter().rposition(wanted);
    let ack = told(|message| matches!(message, DeviceMessage::Ack(ack) if ack.result == ResultCode::WrongSession));
    let reply = told(|message| matches!(message, DeviceMessage::HelloReply(_)));
    assert!(ack.is_some() && ack < reply, "the refusal first, then the answer: {ack:?}, {reply:?}");
    let DeviceMessage::HelloReply(reply) = &bench.messages[reply.unwrap()] else { panic!("a HelloReply") };
    assert_eq!((reply.session, reply.channels_max), (SESSION, 27), "nobody takes it for a session of his own");
    for code in [CommandCode::Hold, CommandCode::Vent, CommandCode::Flush] {
        let command = Command { session: other, code: code.into(), time_us: 0 };
        assert_eq!(bench.request(&command.into()).result, ResultCode::WrongSession);
    }
    assert_eq!(bench.controller.state(), DeviceState::Running);
}

#[test]
fn host_that_takes_over_finds_no_start_armed_and_no_upload_begun() {
    let mut bench = Bench::ready(&[SetpointKind::Pressure]);
    bench.setpoint(0, bench.now_us + 400_000, &[1_000]);
    let start_us = bench.now_us + 300_000;
    let start = Command { session: SESSION, code: CommandCode::Start.into(), time_us: start_us };
    assert_eq!(bench.request(&start.into()).result, ResultCode::Ok);
    let parts = crate::common::upload(&system(), &crate::common::channels(&[SetpointKind::Pressure]));
    let (last, parts) = parts.split_last().expect("an upload");
    for part in parts {
        assert_eq!(bench.request(part).result, ResultCode::Ok);
    }
    bench.heartbeats = false;
    let other = SESSION + 1;
    let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: other }.into();
    bench.ticks(100);
    assert_eq!(bench.request(&hello).result, ResultCode::WrongSession, "the owner was heard 100 ms ago");
    bench.tick();
    assert_eq!(bench.request(&hello).result, ResultCode::Ok);
    let HostMessage::ConfigCommit(commit) = last else { panic!("an upload ends in its commit") };
    let commit = ConfigCommit { session: other, ..commit.clone() };
    assert_eq!(bench.request(&commit.into()).result, ResultCode::ConfigMismatch);
    bench.ticks(500);
    assert_eq!(bench.controller.state(), DeviceState::Ready, "the start went with its host");
    assert_eq!(bench.controller.queue().next_index(), 1, "all else is as it was");
}

#[test]
fn another_schema_is_told_and_gets_no_session() {
    let mut bench = Bench::new();
    let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH ^ 1, session: SESSION };
    assert_eq!(bench.request(&hello.into()).result, ResultCode::SchemaMismatch);
    let told = bench.messages.iter().any(|message| {
        matches!(message, DeviceMessage::HelloReply(reply) if reply.schema_hash == SCHEMA_HASH && reply.session == SESSION)
    });
    assert!(told, "the host learns what the device speaks");
    assert_eq!(bench.command(CommandCode::Flush).result, ResultCode::SchemaMismatch);
    bench.hello();
    assert_eq!(bench.command(CommandCode::Flush).result, ResultCode::Ok, "with the right schema it is welcome");
}
