//! Limits of a plant alone: valves that are left open, the shortest pulse, and the air that a pressure takes.

use std::f64::consts::FRAC_PI_4;

use fra_model::{Actuator, Load};
use softlimb_sim::plant::{ChannelDrive, ChannelSettings, ChannelTruth, Drive, Plant, PlantSettings, TICK_US};

use super::program::{near_pa, steps_pa};
use crate::faults::bench::CHANNELS;

/// Time for the air to cool down and the line to settle before the next step, ticks.
const REST: usize = 1_500;
/// Attempts to come to the level from which a step starts, and distance from which on it is left, Pa.
const TRIMS: usize = 4;
const TRIM_PA: f64 = 500.0;
/// Ticks after which a level is out of reach.
const LONGEST: usize = 20_000;
const TICK_S: f64 = 1e-3;

/// Level at which the shortest pulse is measured, Pa, and time after its start, ticks: the line has settled, the air has hardly cooled down.
const PULSE_AT_PA: f64 = 60e3;
const PULSE_SEEN: usize = 20;

/// Gas constant of air, J/(kg K).
const R_AIR: f64 = 287.05;

/// Limits of a plant, by channel.
pub(super) struct Limits {
    /// Time that a valve takes that is left open, s, by step.
    pub(super) settle_s: Vec<[f64; CHANNELS]>,
    /// Rise of the pressure by the shortest pulse, Pa.
    pub(super) pulse_pa: [f64; CHANNELS],
    chambers: Vec<Holding>,
}

impl Limits {
    pub(super) fn of(settings: &PlantSettings) -> Self {
        let truth = Plant::new(settings).expect("the settings of the bench").truth();
        let chambers = truth.channels.iter().zip(&settings.channels);
        Self {
            settle_s: limits_s(settings),
            pulse_pa: pulse_pa(settings),
            chambers: chambers.map(|(truth, nominal)| Holding::new(truth, nominal, settings)).collect(),
        }
    }

    /// Air that a channel holds at a gauge pressure and the temperature of the room, kg.
    pub(super) fn air_kg(&self, channel: usize, pressure_pa: f64) -> f64 {
        self.chambers[channel].air_kg(pressure_pa)
    }
}

/// Air in one channel.
struct Holding {
    actuator: Actuator<f64>,
    volume_scale: f64,
    /// Fittings, tube and manifold, m3.
    beside_m3: f64,
    atmosphere_pa: f64,
    pa_m3_per_kg: f64,
}

impl Holding {
    fn new(truth: &ChannelTruth, nominal: &ChannelSettings, plant: &PlantSettings) -> Self {
        let (parameters, tube) = (&truth.parameters, nominal.tube);
        let tube_m3 = FRAC_PI_4 * tube.bore_m * tube.bore_m * tube.length_m + tube.manifold_volume_m3;
        Self {
            actuator: parameters.model().expect("an actuator of the bench"),
            volume_scale: parameters.volume_scale,
            beside_m3: parameters.dead_volume_m3 + tube_m3,
            atmosphere_pa: plant.atmosphere_pa,
            pa_m3_per_kg: R_AIR * plant.temperature_k,
        }
    }

    fn air_kg(&self, pressure_pa: f64) -> f64 {
        let inside = self.actuator.forward(pressure_pa, &Load::none()).expect("a pressure of the bench").state;
        let volume_m3 = self.volume_scale * inside.volume_m3 + self.beside_m3;
        (pressure_pa + self.atmosphere_pa) * volume_m3 / self.pa_m3_per_kg
    }
}

/// Rise of the pressure by a coil time that just opens the fill valve, Pa.
fn pulse_pa(settings: &PlantSettings) -> [f64; CHANNELS] {
    let mut plant = Plant::new(settings).expect("the settings of the bench");
    for _ in 0..TRIMS {
        open_until(&mut plant, PULSE_AT_PA, TRIM_PA);
    }
    let before = plant.truth();
    let mut coils_us: [u64; CHANNELS] = std::array::from_fn(|index| {
        let fill = before.channels[index].parameters.fill;
        (fill.on_delay_us + fill.jitter_us).ceil() as u64 + 1
    });
    for _ in 0..PULSE_SEEN {
        let fills_us = coils_us.map(|coil_us| coil_us.min(TICK_US));
        step(&mut plant, &fills_us.map(|fill_us| ChannelDrive { fill_us: fill_us as u16, vent_us: 0 }));
        coils_us = std::array::from_fn(|index| coils_us[index] - fills_us[index]);
    }
    let after = plant.truth();
    std::array::from_fn(|index| after.channels[index].pressure_pa - before.channels[index].pressure_pa)
}

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
