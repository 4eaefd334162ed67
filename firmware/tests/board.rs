//! The board trait: one turn moves samples in, coil times out, and bytes both ways.

use std::collections::VecDeque;

use crate::common::{Bench, SESSION, frame};
use softlimb_firmware::{AdcCode, Board, BootInfo, Controller, LOOK_US, TickInputs, TickOutputs, exchange, turn};
use softlimb_protocol::*;

/// A board whose link takes only a few bytes a turn.
struct Slow {
    now_us: u64,
    incoming: VecDeque<u8>,
    outgoing: Vec<u8>,
    room: usize,
    applied: Vec<TickOutputs>,
}

impl Board for Slow {
    fn inputs(&mut self) -> TickInputs {
        self.now_us += 1_000;
        self.room = 5;
        let (pressure, supply, valve_supply) = ([AdcCode(410); MAX_CHANNELS], AdcCode(2_000), AdcCode(2_708));
        TickInputs { now_us: self.now_us, pressure, supply, valve_supply, emergency_stop: false }
    }

    fn apply(&mut self, outputs: &TickOutputs) {
        self.applied.push(*outputs);
    }

    fn read_link(&mut self, into: &mut [u8]) -> usize {
        let count = into.len().min(self.incoming.len());
        for (place, byte) in into.iter_mut().zip(self.incoming.drain(..count)) {
            *place = byte;
        }
        count
    }

    fn link_room(&self) -> usize {
        self.room
    }

    fn write_link(&mut self, bytes: &[u8]) {
        assert!(bytes.len() <= self.room);
        self.room -= bytes.len();
        self.outgoing.extend(bytes);
    }
}

#[test]
fn slow_link_delays_bytes_and_loses_none() {
    let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION };
    let mut bytes = frame(1, &hello.into());
    for number in 0..4 {
        bytes.extend(frame(2, &Heartbeat { session: SESSION, host_time_us: number }.into()));
    }
    let mut board = Slow { now_us: 0, incoming: bytes.into(), outgoing: Vec::new(), room: 0, applied: Vec::new() };
    let mut controller = Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 });
    for _ in 0..60 {
        turn(&mut controller, &mut board);
    }
    assert_eq!(board.applied, [TickOutputs::SAFE; 60]);
    let mut decoder = Decoder::<DeviceMessage>::new();
    let frames: Vec<_> = board.outgoing.iter().filter_map(|&byte| decoder.push(byte)).map(Result::unwrap).collect();
    assert!(matches!(&frames[0].message, DeviceMessage::HelloReply(reply) if reply.session == SESSION));
    assert!(matches!(&frames[1].message, DeviceMessage::Ack(ack) if ack.result == ResultCode::Ok));
    let heartbeats: Vec<_> = frames[2..]
        .iter()
        .map(|frame| match &frame.message {
            DeviceMessage::HeartbeatReply(reply) => (reply.host_time_us, reply.mcu_time_us),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(heartbeats, [(0, 1_000), (1, 1_000), (2, 1_000), (3, 1_000)]);
}

#[test]
fn look_between_two_turns_of_a_running_device_answers_at_its_own_time() {
    for is_running in [false, true] {
        let Bench { mut controller, now_us, .. } =
            if is_running { Bench::running(1, 40_000, 60) } else { Bench::ready(&[SetpointKind::Pressure]) };
        while controller.transmit(&mut [0; 64]) > 0 {}
        let mut board = Slow { now_us, incoming: VecDeque::new(), outgoing: Vec::new(), room: 1_000, applied: vec![] };
        exchange(&mut controller, &mut board, now_us + LOOK_US);
        assert_eq!(board.outgoing, [], "nothing arrived");
        let beat = frame(2, &Heartbeat { session: SESSION, host_time_us: 7 }.into());
        board.incoming.extend(&beat);
        exchange(&mut controller, &mut board, now_us + LOOK_US);
        assert_eq!(board.applied, [], "a look moves nothing");
        let mut decoder = Decoder::<DeviceMessage>::new();
        let frames: Vec<_> = board.outgoing.iter().filter_map(|&byte| decoder.push(byte)).map(Result::unwrap).collect();
        if is_running {
            let DeviceMessage::HeartbeatReply(reply) = &frames[0].message else { panic!("{frames:?}") };
            assert_eq!((reply.host_time_us, reply.mcu_time_us), (7, now_us + 500));
        } else {
            assert_eq!((frames.len(), board.incoming.len()), (0, beat.len()), "left to the next turn");
        }
    }
}
