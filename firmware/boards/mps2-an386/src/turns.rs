//! Questions to the controller: turns of nine channels that follow a trajectory.

use softlimb_firmware::{TICK_US, ValvePulse};
use softlimb_protocol::{Command, DeviceState};

use crate::Desk;
use crate::answer::{Answer, Note};
use crate::rig::{LINE, Rig, TickOutputs};
use crate::upload::{Way, configuration, knot, start};

/// Time from knot to knot, us, and knots that are sent ahead.
const KNOT_US: u64 = 20_000;
const AHEAD: u32 = 30;

/// Turns until a device with good sensors is ready, at most.
const PATIENCE: usize = 200;

/// Turns that are counted: a round of the trajectory, and half a second of garbage.
const TURNS: u64 = 1_600;
const GARBAGE: usize = 500;

impl Answer for TickOutputs {
    fn note(&self) -> Note {
        let pulse = |ValvePulse { fill_us, vent_us }: &ValvePulse| f32::from(*fill_us) - f32::from(*vent_us);
        Note::of("-", 0, self.valves.iter().map(pulse).chain([f32::from(self.pump_duty)]))
    }
}

/// Puts all questions; whether the device did what it was told.
pub(crate) fn put_all(desk: &mut impl Desk) -> bool {
    let tables = run(desk, Way::Tables, "nine channels, by tables");
    let model = run(desk, Way::Model, "nine channels, by model");
    tables && model
}

fn run(desk: &mut impl Desk, way: Way, name: &str) -> bool {
    let mut rig = Rig::new();
    configuration(way, |message| {
        rig.send(&message);
        let outputs = desk.put("turn, configuration", name, || rig.turn());
        rig.pass(&outputs);
    });
    for _ in 0..PATIENCE {
        let outputs = rig.turn();
        rig.pass(&outputs);
    }
    // A message a turn, then the start.
    let begin_us = rig.now_us() + 2 * KNOT_US + u64::from(AHEAD * TICK_US);
    let knot = |index: u32| knot(index, begin_us + KNOT_US * u64::from(index)).into();
    (0..AHEAD).for_each(|index| rig.tell(&knot(index)));
    let start: Command = start();
    rig.tell(&start.into());
    for number in 0..TURNS {
        // One knot at a time, as a host sends them.
        if number % 20 == 7 {
            rig.send(&knot(AHEAD + (number / 20) as u32));
        }
        let outputs = desk.put("turn", name, || rig.turn());
        rig.pass(&outputs);
    }
    let well = rig.state() == DeviceState::Running && rig.is_well();
    let mut word = 0x2545_f491_u32;
    for _ in 0..GARBAGE {
        rig.send_garbage([(); LINE].map(|()| {
            word ^= word << 13;
            word ^= word >> 17;
            word ^= word << 5;
            word as u8
        }));
        let outputs = desk.put("turn, garbage on the link", name, || rig.turn());
        rig.pass(&outputs);
    }
    well && rig.state() == DeviceState::Running && rig.is_well()
}
