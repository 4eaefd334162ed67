//! A limit, on the plant without a device: valves without delays, whose loop reads the true pressure.

use softlimb_sim::plant::{ChannelDrive, Drive, Plant, PlantSettings};

use super::bench::{Moment, Recording};
use super::program::{end_s, knots_pa, reference_pa};
use crate::faults::bench::CHANNELS;

const TICK_US: u16 = 1_000;
const TICK_S: f64 = 1e-3;

/// Ticks that the chambers rest before the start.
const BEFORE: usize = 200;

/// Effect of a tick that a valve is credited with before its first whole one, Pa.
const FIRST_EFFECT_PA: f64 = 500.0;

/// Runs the program on a plant whose valves switch at once.
pub(super) fn record(settings: &PlantSettings) -> Recording {
    let mut plant = Plant::new(&without_delay(settings)).expect("the settings of the bench");
    let mut loops: [Loop; CHANNELS] = std::array::from_fn(|_| Loop::new());
    let knots_pa = knots_pa();
    let mut moments = Vec::new();
    let ticks = (end_s() / TICK_S).round() as usize;
    for tick in 0..BEFORE + ticks {
        let time_s = (tick as f64 - BEFORE as f64) * TICK_S;
        let truth = plant.truth();
        let wanted_pa = reference_pa(&knots_pa, (time_s + TICK_S).max(0.0));
        let channels: [ChannelDrive; CHANNELS] =
            std::array::from_fn(|channel| loops[channel].drive(truth.channels[channel].pressure_pa, wanted_pa));
        plant.step(&Drive { channels: &channels, supply_open: true, pump: 1.0, gripper_on: false });
        if tick >= BEFORE {
            moments.push(Moment::of(&plant.truth(), time_s + TICK_S));
        }
    }
    Recording { moments, fault: None }
}

fn without_delay(settings: &PlantSettings) -> PlantSettings {
    let mut settings = settings.clone();
    for channel in &mut settings.channels {
        (channel.valve.on_delay_us, channel.valve.off_delay_us, channel.valve.jitter_us) = (0.0, 0.0, 0.0);
    }
    settings
}

/// The loop of one channel: a valve is open in each tick for as long as the pressure lacks, by its last effect.
struct Loop {
    last_pa: f64,
    last: ChannelDrive,
    /// Change of the pressure by a whole tick of the fill and of the vent valve, Pa.
    effects_pa: [f64; 2],
}

impl Loop {
    fn new() -> Self {
        Self { last_pa: 0.0, last: ChannelDrive::default(), effects_pa: [FIRST_EFFECT_PA; 2] }
    }

    fn drive(&mut self, pressure_pa: f64, wanted_pa: f64) -> ChannelDrive {
        let change_pa = pressure_pa - self.last_pa;
        for (effect_pa, (coil_us, moved_pa)) in
            self.effects_pa.iter_mut().zip([(self.last.fill_us, change_pa), (self.last.vent_us, -change_pa)])
        {
            if coil_us == TICK_US && moved_pa > 0.0 {
                *effect_pa = moved_pa;
            }
        }
        let lacking_pa = wanted_pa - pressure_pa;
        let coil_us = |lacking_pa: f64, effect_pa: f64| (lacking_pa / effect_pa).clamp(0.0, 1.0) * f64::from(TICK_US);
        let drive = ChannelDrive {
            fill_us: coil_us(lacking_pa, self.effects_pa[0]) as u16,
            vent_us: coil_us(-lacking_pa, self.effects_pa[1]) as u16,
        };
        (self.last_pa, self.last) = (pressure_pa, drive);
        drive
    }
}
