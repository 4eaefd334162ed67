//! A trial: the device behind its link with an eye on the truth.

use std::io;

use softlimb_protocol::PressureLoopKind;
use softlimb_rig::link::{Event, Knot, Outputs, StreamOptions, Transport, stream};
use softlimb_sim::plant::{PlantSettings, Truth};
use softlimb_sim::{Here, SimSettings, SimulatedMcu, here};

use super::program::knots_pa;
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
    /// Air that each took from the supply since the start, kg.
    pub air_kg: [f64; CHANNELS],
}

impl Moment {
    pub(super) fn of(truth: &Truth, time_s: f64) -> Self {
        let channel = |index: usize| &truth.channels[index];
        Self {
            time_s,
            pressure_pa: std::array::from_fn(|index| channel(index).pressure_pa),
            open: std::array::from_fn(|index| [channel(index).fill_open, channel(index).vent_open]),
            air_kg: std::array::from_fn(|index| channel(index).air_used_kg),
        }
    }
}

/// A run from its start on.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The ticks.
    pub moments: Vec<Moment>,
    /// The fault that ended it, in words.
    pub fault: Option<String>,
}

/// Runs the program on a plant, by a loop of the firmware.
#[must_use]
pub fn record(plant: &PlantSettings, pressure_loop: PressureLoopKind) -> Recording {
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
    let mut configuration = configuration();
    configuration.system.pressure_loop = pressure_loop.into();
    let outcome = stream(&mut watched, &configuration, &knots, &StreamOptions::new(7), |watched, event| {
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
        self.moments.push(Moment::of(&self.mcu.truth(), time_s));
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
