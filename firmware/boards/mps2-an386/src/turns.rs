//! Queries to the controller: turns of nine channels that follow a trajectory.

use softlimb_firmware::{TICK_US, ValvePulse};
use softlimb_protocol::{Command, DeviceState, HostMessage};

use crate::Bench;
use crate::answer::{Answer, Note};
use crate::fixture::{Fixture, LINE, TickOutputs};
use crate::frames::written;
use crate::upload::{FRAME, Inverse, KNOT_US, configuration, knot, knots, start};

/// Knots that are sent ahead.
const AHEAD: u32 = 52;

/// Turns from one frame of knots to the next.
const FRAME_TURNS: u64 = FRAME as u64 * KNOT_US as u64 / TICK_US as u64;

/// Turns until a device with good sensors is ready, at most.
const TURNS_UNTIL_READY: usize = 700;

/// Turns that are counted: a round of the trajectory, and half a second of garbage.
const TURNS: u64 = 1_600;
const GARBAGE: usize = 500;

impl Answer for TickOutputs {
    fn note(&self) -> Note {
        let pulse = |ValvePulse { fill_us, vent_us }: &ValvePulse| f32::from(*fill_us) - f32::from(*vent_us);
        Note::of(
            "-",
            0,
            self.valves.iter().map(pulse).chain([f32::from(self.pump_duty), f32::from(self.digital.bits())]),
        )
    }
}

/// Puts all queries; whether the device followed its commands.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    let tables = run(bench, Inverse::Tables, "nine channels, by tables");
    let model = run(bench, Inverse::Model, "nine channels, by model");
    tables && model
}

fn run(bench: &mut impl Bench, inverse: Inverse, name: &str) -> bool {
    let mut fixture = Fixture::new();
    configuration(inverse, |message| {
        fixture.send(&message);
        let outputs = bench.put("turn, configuration", name, || fixture.turn());
        fixture.pass(&outputs);
    });
    for _ in 0..TURNS_UNTIL_READY {
        let outputs = fixture.turn();
        fixture.pass(&outputs);
    }
    // A message a turn, then the start.
    let begin_us = fixture.now_us() + 4 * u64::from(KNOT_US) + u64::from(AHEAD * TICK_US);
    let knot = |index: u32| knot(index, begin_us + u64::from(KNOT_US) * u64::from(index)).into();
    (0..AHEAD).for_each(|index| fixture.tell(&knot(index)));
    let start: Command = start();
    fixture.tell(&start.clone().into());
    let mut bytes = written(&HostMessage::from(start));
    for number in 0..TURNS {
        // Frames of knots, as a host sends them, at the speed of the line.
        let (frame, turn) = (number / FRAME_TURNS, number % FRAME_TURNS);
        if turn == 0 {
            bytes = written(&HostMessage::from(knots(AHEAD + FRAME * frame as u32)));
        }
        if let Some(part) = bytes.0[..bytes.1].chunks(LINE).nth(turn as usize) {
            fixture.send_bytes(part);
        }
        let outputs = bench.put("turn", name, || fixture.turn());
        fixture.pass(&outputs);
    }
    let well = fixture.state() == DeviceState::Running && fixture.is_well();
    let mut word = 0x2545_f491_u32;
    for _ in 0..GARBAGE {
        fixture.send_bytes(&[(); LINE].map(|()| {
            word ^= word << 13;
            word ^= word >> 17;
            word ^= word << 5;
            word as u8
        }));
        let outputs = bench.put("turn, garbage on the link", name, || fixture.turn());
        fixture.pass(&outputs);
    }
    well && fixture.state() == DeviceState::Running && fixture.is_well()
}
