//! A bench: actuators on a simulated MCU, setpoints through the link, and an eye on the truth at every tick.

use std::collections::VecDeque;
use std::io;

use fra_model::State;
use softlimb_protocol::{ConfigInverse, ConfigVolume, Fault, Outputs};
use softlimb_rig::link::{DeviceConfiguration, Event, Knot, StreamOptions, Transport, stream};
use softlimb_sim::plant::{ChannelSettings, PlantSettings, Spread, Supply, Truth};
use softlimb_sim::{SimSettings, SimulatedMcu};

use crate::actuators::{Subject, system};

/// Time between two knots, us.
const KNOT_US: u64 = 20_000;
/// Ticks that the eye remembers before the start is known; the device is armed less than a second ahead.
const BEFORE_START: usize = 2_000;

/// A plant that is exactly what the device is told: no spread, no creep. Sensors and valves keep their noise and jitter.
pub(crate) fn nominal(subjects: &[Subject]) -> PlantSettings {
    let channels = subjects.iter().map(|subject| ChannelSettings {
        pressure_max_pa: 130e3,
        creep_share: 0.0,
        ..ChannelSettings::new(subject.parameters)
    });
    let mut plant = PlantSettings::new(11, channels.collect());
    plant.supply = Supply::Regulated { pressure_pa: 200e3 };
    plant.spread = Spread::NONE;
    plant
}

/// One tick of a run.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    /// Time since the start, s.
    pub(crate) time_s: f64,
    pub(crate) supply_pa: f64,
    pub(crate) air_used_kg: f64,
    /// True chamber pressure, Pa, and state, of each channel.
    pub(crate) channels: Vec<(f64, State<f64>)>,
}

/// A run from its start to its last knot.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) moments: Vec<Moment>,
    pub(crate) faults: Vec<Fault>,
}

impl Run {
    /// The moments of a stretch of time, s.
    pub(crate) fn between(&self, from_s: f64, to_s: f64) -> impl Iterator<Item = &Moment> {
        self.moments.iter().filter(move |moment| (from_s..to_s).contains(&moment.time_s))
    }

    /// RMS of pressure minus `wanted_pa` of the time, over a stretch of time, Pa.
    pub(crate) fn pressure_rmse_pa(
        &self,
        channel: usize,
        (from_s, to_s): (f64, f64),
        wanted_pa: impl Fn(f64) -> f64,
    ) -> f64 {
        rms(self.between(from_s, to_s).map(|moment| moment.channels[channel].0 - wanted_pa(moment.time_s)))
    }
}

pub(crate) fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = errors.fold((0.0, 0), |(sum, count), error| (sum + error * error, count + 1));
    assert!(count > 0, "nothing to average");
    (sum / f64::from(count)).sqrt()
}

/// Runs setpoints for `seconds`: `setpoint(channel, time)` in SI units at knots 20 ms apart, linear in between as the device has it.
pub(crate) fn run(
    plant: PlantSettings,
    subjects: &[Subject],
    seconds: f64,
    setpoint: impl Fn(usize, f64) -> f64,
) -> Run {
    let knots: Vec<Knot> = (0..=(seconds * 1e6 / KNOT_US as f64).round() as u64)
        .map(|index| {
            let time_us = index * KNOT_US;
            let value = |(channel, subject): (usize, &Subject)| {
                subject.kind.to_wire(setpoint(channel, time_us as f64 * 1e-6)).expect("a setpoint that fits")
            };
            Knot { time_us, outputs: Outputs::default(), values: subjects.iter().enumerate().map(value).collect() }
        })
        .collect();
    let mut configuration = DeviceConfiguration {
        system: system(),
        channels: subjects.iter().map(Subject::channel).collect(),
        volumes: Vec::new(),
        inverses: Vec::new(),
    };
    for (channel, subject) in (0..).zip(subjects) {
        if let Some((volume, inverse)) = subject.tables() {
            configuration.volumes.push(ConfigVolume { channel, ..volume });
            configuration.inverses.extend(inverse.map(|inverse| ConfigInverse { channel, ..inverse }));
        }
    }
    let mut device = Watched::new(SimulatedMcu::new(&SimSettings::new(plant)).expect("sound settings"));
    let mut faults = Vec::new();
    let outcome = stream(&mut device, &configuration, &knots, &StreamOptions::new(1), |device, event| match event {
        Event::Armed { start_us, end_us } => device.armed = Some((start_us, end_us)),
        Event::Fault { message, .. } => faults.push(message),
        _ => {}
    });
    if let Err(error) = outcome {
        panic!("{error}; faults {faults:?}");
    }
    Run { moments: device.moments(), faults }
}

/// A simulated device whose truth is kept, tick by tick, from the start of the trajectory to its end.
struct Watched {
    device: SimulatedMcu,
    armed: Option<(u64, u64)>,
    seen: VecDeque<(u64, Moment)>,
}

impl Watched {
    fn new(device: SimulatedMcu) -> Self {
        Self { device, armed: None, seen: VecDeque::new() }
    }

    fn look(&mut self) {
        let time_us = self.device.device_time_us();
        let over = self.armed.is_some_and(|(_, end_us)| time_us > end_us);
        if over || self.seen.back().is_some_and(|(last_us, _)| *last_us == time_us) {
            return;
        }
        if self.armed.is_none() && self.seen.len() == BEFORE_START {
            self.seen.pop_front();
        }
        self.seen.push_back((time_us, moment(&self.device.truth())));
    }

    fn moments(self) -> Vec<Moment> {
        let (start_us, _) = self.armed.expect("the run was armed");
        let since = |time_us: u64| Some(time_us.checked_sub(start_us)? as f64 * 1e-6);
        self.seen
            .into_iter()
            .filter_map(|(time_us, moment)| Some(Moment { time_s: since(time_us)?, ..moment }))
            .collect()
    }
}

fn moment(truth: &Truth) -> Moment {
    Moment {
        time_s: 0.0,
        supply_pa: truth.supply_pressure_pa,
        air_used_kg: truth.air_used_kg,
        channels: truth.channels.iter().map(|channel| (channel.pressure_pa, channel.shape)).collect(),
    }
}

impl Transport for Watched {
    fn now_us(&self) -> u64 {
        Transport::now_us(&self.device)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.device.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        self.device.receive(into)
    }

    fn wait_until(&mut self, deadline_us: u64) {
        while !self.device.is_readable() && Transport::now_us(&self.device) < deadline_us {
            let tick_us = self.device.next_tick_us().min(deadline_us);
            self.device.advance_to(tick_us);
            self.look();
        }
    }
}
