//! A trial: the device behind its link with an eye on the truth, and the plant alone with valves that are left open.

use std::io;

use softlimb_rig::link::{Event, Knot, Outputs, StreamOptions, Transport, stream};
use softlimb_sim::plant::{ChannelDrive, Drive, Plant, PlantSettings};
use softlimb_sim::{Here, SimSettings, SimulatedMcu, here};

use super::program::{knots_pa, near_pa, steps_pa};
use crate::faults::bench::{CHANNELS, KNOT_US, configuration};

/// The truth at the end of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time since the start, s.
    pub time_s: f64,
    /// Gauge pressure in each chamber, Pa.
    pub pressure_pa: [f64; CHANNELS],
    /// Whether the fill and the vent valve of each pass air.
    pub open: [[bool; 2]; CHANNELS],
}

/// A run from its start on.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The ticks.
    pub moments: Vec<Moment>,
    /// The fault that ended it, in words.
    pub fault: Option<String>,
}

/// Runs the program on a plant.
#[must_use]
pub fn record(plant: &PlantSettings) -> Recording {
    let values = |pressure_pa: f64| vec![pressure_pa as i32; CHANNELS];
    let knots: Vec<_> = (0..)
        .zip(knots_pa())
        .map(|(index, pressure_pa)| Knot {
            time_us: index * KNOT_US,
            outputs: Outputs::default(),
            values: values(pressure_pa),
        })
        .collect();
    let settings = SimSettings::new(plant.clone());
    let mcu = SimulatedMcu::with_processor(&settings, here()).expect("the settings of the bench");
    let mut watched = Watched { mcu, span_us: None, moments: Vec::new() };
    let outcome = stream(&mut watched, &configuration(), &knots, &StreamOptions::new(7), |watched, event| {
        if let Event::Armed { start_us, end_us } = event {
            watched.span_us = Some((start_us, end_us));
        }
    });
    Recording { moments: watched.moments, fault: outcome.err().map(|error| error.to_string()) }
}

struct Watched {
    mcu: SimulatedMcu<Here>,
    /// Device times of start and end, us.
    span_us: Option<(u64, u64)>,
    moments: Vec<Moment>,
}

impl Watched {
    fn look(&mut self) {
        let now_us = self.mcu.device_time_us();
        let Some((start_us, end_us)) = self.span_us else { return };
        if !(start_us..=end_us).contains(&now_us) {
            return;
        }
        let time_s = (now_us - start_us) as f64 * 1e-6;
        if self.moments.last().is_some_and(|last| last.time_s >= time_s) {
            return;
        }
        let truth = self.mcu.truth();
        let mut moment = Moment { time_s, pressure_pa: [0.0; CHANNELS], open: [[false; 2]; CHANNELS] };
        for (index, channel) in truth.channels.iter().enumerate() {
            moment.pressure_pa[index] = channel.pressure_pa;
            moment.open[index] = [channel.fill_open, channel.vent_open];
        }
        self.moments.push(moment);
    }
}

impl Transport for Watched {
    fn now_us(&self) -> u64 {
        self.mcu.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.mcu.write(bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        self.mcu.read(into);
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        while !self.mcu.is_readable() && self.mcu.now_us() < deadline_us {
            self.mcu.advance_to(self.mcu.next_tick_us().max(self.mcu.now_us() + 1).min(deadline_us));
            self.look();
        }
    }
}

/// Time for the air to cool down and the line to settle before the next step, ticks.
const REST: usize = 1_500;
/// Attempts to come to the level from which a step starts, and distance from which on it is left, Pa.
const TRIMS: usize = 4;
const TRIM_PA: f64 = 500.0;
/// Ticks after which a level is out of reach.
const LONGEST: usize = 20_000;
const TICK_S: f64 = 1e-3;

/// Time that a valve, opened at the beginning of each step and left open, takes until the chamber comes near to the level, s.
#[must_use]
pub fn limits_s(plant: &PlantSettings) -> Vec<[f64; CHANNELS]> {
    let mut plant = Plant::new(plant).expect("the settings of the bench");
    let mut limits_s = Vec::new();
    for (from_pa, to_pa) in steps_pa() {
        // Air that was compressed cools down: the level is taken again until the chamber rests there.
        for _ in 0..TRIMS {
            open_until(&mut plant, from_pa, TRIM_PA);
        }
        limits_s.push(open_until(&mut plant, to_pa, near_pa(from_pa, to_pa)));
    }
    limits_s
}

fn open_until(plant: &mut Plant, level_pa: f64, near_pa: f64) -> [f64; CHANNELS] {
    let pressures = |plant: &Plant| plant.truth().channels.iter().map(|it| it.pressure_pa).collect::<Vec<_>>();
    let mut last_pa = pressures(plant);
    let upwards: Vec<bool> = last_pa.iter().map(|pressure_pa| *pressure_pa < level_pa).collect();
    let is_far = |index: usize| (last_pa[index] - level_pa).abs() > TRIM_PA;
    let mut open: [bool; CHANNELS] = std::array::from_fn(is_far);
    let mut near_s = open.map(|is_open| if is_open { f64::NAN } else { 0.0 });
    for tick in 1..=LONGEST {
        let coil = |index: usize| match (open[index], upwards[index]) {
            (false, _) => ChannelDrive::default(),
            (true, true) => ChannelDrive { fill_us: 1_000, vent_us: 0 },
            (true, false) => ChannelDrive { fill_us: 0, vent_us: 1_000 },
        };
        step(plant, &std::array::from_fn::<_, CHANNELS, _>(coil));
        let now_pa = pressures(plant);
        for index in 0..CHANNELS {
            let towards = if upwards[index] { 1.0 } else { -1.0 };
            let left_pa = towards * (level_pa - now_pa[index]);
            if near_s[index].is_nan() && left_pa <= near_pa {
                near_s[index] = tick as f64 * TICK_S;
            }
            // The coil goes off so early that the closing valve leaves the chamber at the level.
            let closing_pa = 2.0 * towards * (now_pa[index] - last_pa[index]);
            open[index] &= left_pa > closing_pa;
        }
        last_pa = now_pa;
        if open == [false; CHANNELS] && near_s.iter().all(|near_s| near_s.is_finite()) {
            break;
        }
    }
    (0..REST).for_each(|_| step(plant, &[ChannelDrive::default(); CHANNELS]));
    near_s
}

fn step(plant: &mut Plant, channels: &[ChannelDrive]) {
    plant.step(&Drive { channels, supply_open: true, pump: 1.0, gripper_on: false });
}
