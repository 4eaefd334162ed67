//! Control of pressure: errors of chambers of three sizes, and settling times beside that of a valve that stays open.

mod bench;
mod command;
mod figures;
mod limits;
mod picture;
mod program;
mod swift;
mod table;

pub use bench::{Moment, Recording, record};
pub use figures::Figures;
pub use limits::limits_s;
pub use table::{HEADING, Line, PLACE, lines, page, parse};

pub(crate) use command::Control;

use std::num::NonZero;
use std::thread;

use softlimb_numerics::Kronecker;
use softlimb_protocol::PressureLoopKind;
use softlimb_sim::plant::{ChannelSettings, MotionSettings, PlantSettings, PumpSettings, Spread, Supply};

use crate::faults::bench::settings;

/// Number of plants that differ from the device's configuration.
pub const PLANTS: u64 = 60;

/// Amplitude, m3, and frequency, Hz, of the volume change by the limb's motion.
const MOTION: MotionSettings = MotionSettings { amplitude_m3: 0.7e-6, frequency_hz: 2.0 };

/// Standard deviations of the widest spread: volumes to 30 %, conductances to 20 %, delays to 30 %. Sensors are exact: a sensor's error is the pressure's error.
const WIDEST: Spread = Spread {
    modulus: 0.05,
    wall_thickness: 0.02,
    fiber_angle_rad: 0.009,
    volume: 0.1,
    dead_volume: 0.2,
    valve_conductance: 0.067,
    valve_delay: 0.1,
    sensor_offset: 0.0,
    sensor_gain: 0.0,
};

/// Greatest deviations of volume and conductance that the device is not told: 17 % and 11 % RMS.
pub const UNTOLD_VOLUME: f64 = 0.3;
/// See [`UNTOLD_VOLUME`].
pub const UNTOLD_CONDUCTANCE: f64 = 0.2;

/// A loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// One of the firmware's, behind its link.
    Firmware(PressureLoopKind),
    /// The limit of the valves' size: valves without delays, for as long in each tick as the true pressure lacks.
    Swift,
}

impl Method {
    /// The loop that scenes have by default.
    pub const OURS: Self = Self::Firmware(PressureLoopKind::Pulses);

    /// All loops, in the order of the table.
    pub const ALL: [Self; 4] = [
        Self::OURS,
        Self::Firmware(PressureLoopKind::ProportionalIntegral),
        Self::Firmware(PressureLoopKind::OnOff),
        Self::Swift,
    ];

    /// Name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Firmware(PressureLoopKind::Pulses) => "pulses",
            Self::Firmware(PressureLoopKind::ProportionalIntegral) => "PI, feed-forward",
            Self::Firmware(PressureLoopKind::OnOff) => "on-off",
            Self::Swift => "valves without delay",
        }
    }
}

/// A group of plants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// As in the device's configuration.
    Nominal,
    /// Nominal, while the limb's motion changes the volumes.
    Moved,
    /// Nominal, with a pump and a reservoir as supply.
    Pump,
    /// Plants of the widest spread.
    Spread,
    /// Plants whose volumes and conductances alone differ, evenly up to [`UNTOLD_VOLUME`] and [`UNTOLD_CONDUCTANCE`].
    Untold,
}

impl Group {
    /// All groups, in the order of the table.
    pub const ALL: [Self; 5] = [Self::Nominal, Self::Moved, Self::Pump, Self::Spread, Self::Untold];

    /// Name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Moved => "nominal, moved",
            Self::Pump => "nominal, pump",
            Self::Spread => "60 plants",
            Self::Untold => "60 untold",
        }
    }

    /// Whether it has more than one plant.
    #[must_use]
    pub fn is_many(self) -> bool {
        matches!(self, Self::Spread | Self::Untold)
    }

    /// Seeds of its plants.
    #[must_use]
    pub fn seeds(self) -> std::ops::RangeInclusive<u64> {
        if self.is_many() { 1..=PLANTS } else { 1..=1 }
    }

    /// The plant of a seed.
    #[must_use]
    pub fn plant(self, seed: u64) -> PlantSettings {
        let mut plant = settings(seed).plant;
        plant.spread = if self == Self::Spread { WIDEST } else { Spread::NONE };
        plant.supply = Supply::Regulated { pressure_pa: 200e3 };
        match self {
            Self::Pump => plant.supply = Supply::Pump(PumpSettings::default()),
            Self::Moved => plant.channels.iter_mut().for_each(|channel| channel.motion = MOTION),
            Self::Untold => plant.channels.iter_mut().for_each(|channel| untold(channel, seed)),
            Self::Nominal | Self::Spread => {}
        }
        plant
    }
}

/// Changes volume and conductance, evenly over the plants.
fn untold(channel: &mut ChannelSettings, seed: u64) {
    let points = Kronecker::new(2, 0);
    let factor = |axis: usize, most: f64| 1.0 + most * (2.0 * points.coordinate(seed as usize, axis) - 1.0);
    channel.actuator.length_m *= factor(0, UNTOLD_VOLUME);
    channel.valve.conductance_m3_per_s_pa *= factor(1, UNTOLD_CONDUCTANCE);
}

/// A plant with its recording and the figures of each channel.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The loop.
    pub method: Method,
    /// The group of the plant.
    pub group: Group,
    /// The recording.
    pub recording: Recording,
    /// Figures of each channel; `None` where a fault ended the run.
    pub figures: Option<Vec<Figures>>,
}

/// Runs the plants of the groups by each loop, side by side, in their order.
#[must_use]
pub fn run(groups: &[Group]) -> Vec<Trial> {
    let of_method = |method| groups.iter().map(move |group| (method, *group));
    let runs = Method::ALL.into_iter().flat_map(of_method);
    let plants: Vec<_> =
        runs.flat_map(|(method, group)| group.seeds().map(move |seed| (method, group, seed))).collect();
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let share = plants.len().div_ceil(threads).max(1);
    thread::scope(|scope| {
        let trials = |part: &[(Method, Group, u64)]| part.iter().map(|run| trial(*run)).collect::<Vec<_>>();
        let parts: Vec<_> = plants.chunks(share).map(|part| scope.spawn(move || trials(part))).collect();
        parts.into_iter().flat_map(|part| part.join().expect("a trial")).collect()
    })
}

fn trial((method, group, seed): (Method, Group, u64)) -> Trial {
    let plant = group.plant(seed);
    let recording = match method {
        Method::Firmware(pressure_loop) => record(&plant, pressure_loop),
        Method::Swift => swift::record(&plant),
    };
    let mut figures = recording.fault.is_none().then(|| figures::of(&recording, &limits::Limits::of(&plant)));
    if method == Method::Swift {
        // Its valves switch within a tick.
        for figures in figures.iter_mut().flatten() {
            (figures.sine_ratio, figures.switchings_per_s) = (f64::NAN, f64::NAN);
        }
    }
    Trial { method, group, recording, figures }
}
