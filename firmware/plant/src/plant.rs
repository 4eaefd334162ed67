//! The plant: all channels on one supply, one tick at a time.

use crate::channel::Channel;
use crate::check::check;
use crate::error::PlantError;
use crate::fault::{ChannelFault, TimedFault};
use crate::gripper::Gripper;
use crate::random::Random;
use crate::sensor::Sensor;
use crate::settings::PlantSettings;
use crate::spread::calibration;
use crate::supply::Source;
use crate::truth::Truth;

/// Duration of one step of the plant, us.
pub const TICK_US: u64 = 1_000;

/// Times that the coils of one channel are energised, from the start of the tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChannelDrive {
    /// Fill valve, us; 0..=1000, more counts as 1000. A coil on to the end of one tick and from
    /// the start of the next stays on.
    pub fill_us: u16,
    /// Vent valve, us; as `fill_us`.
    pub vent_us: u16,
}

/// Everything that drives the plant for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive<'a> {
    /// One entry per channel. Outputs beyond the channels of the plant drive nothing; channels
    /// without an output have their coils off.
    pub channels: &'a [ChannelDrive],
    /// Whether the supply reaches the fill valves.
    pub supply_open: bool,
    /// Share of the pump's full speed; clamped to 0..=1, NaN is 0.
    pub pump: f64,
    /// Whether the output of the gripper is on: it closes then.
    pub gripper_on: bool,
}

/// Simulated pneumatics and actuators.
#[derive(Clone, Debug)]
pub struct Plant {
    time_us: u64,
    source: Source,
    channels: Vec<Channel>,
    supply_sensor: Sensor,
    gripper: Gripper,
    random: Random,
    pressure_codes: Vec<u16>,
    supply_code: u16,
    air_used_kg: f64,
    ambient_abs_pa: f64,
    room_k: f64,
    /// By falling time: the next one is the last.
    pending_faults: Vec<TimedFault>,
}

impl Plant {
    /// Checks the settings, draws the true parameters by the seed and builds the plant at rest:
    /// actuators at ambient pressure, valves closed.
    ///
    /// # Errors
    /// [`PlantError`] names the first setting that is not accepted, or the channel whose actuator
    /// the model cannot solve.
    pub fn new(settings: &PlantSettings) -> Result<Self, PlantError> {
        check(settings)?;
        let channels =
            (0..settings.channels.len()).map(|index| Channel::new(settings, index)).collect::<Result<Vec<_>, _>>()?;
        let supply_sensor = |random: &mut Random| calibration(&settings.supply_sensor, &settings.spread, random);
        let (offset, gain) = supply_sensor(&mut Random::new(settings.seed, 0));
        // Noise is what follows the parameters in the stream, whichever seed these came from.
        let mut random = Random::new(settings.noise_seed, 0);
        supply_sensor(&mut random);
        let mut pending_faults = settings.faults.clone();
        pending_faults.sort_by_key(|fault| core::cmp::Reverse(fault.time_us));
        let mut plant = Self {
            time_us: 0,
            source: Source::new(settings),
            pressure_codes: vec![0; channels.len()],
            channels,
            supply_sensor: Sensor::new(settings.supply_sensor, offset, gain),
            gripper: Gripper::new(settings.gripper_time_s),
            random,
            supply_code: 0,
            air_used_kg: 0.0,
            ambient_abs_pa: settings.atmosphere_pa,
            room_k: settings.temperature_k,
            pending_faults,
        };
        plant.supply_sensor.settle(plant.source.abs_pa() - plant.ambient_abs_pa);
        plant.sample();
        Ok(plant)
    }

    /// Advances by one tick of [`TICK_US`].
    pub fn step(&mut self, drive: &Drive<'_>) {
        self.break_due_parts();
        let supply = self.source.abs_pa();
        let reaching = drive.supply_open.then_some(supply);
        let mut drawn_kg = 0.0;
        for (index, channel) in self.channels.iter_mut().enumerate() {
            let coils = drive.channels.get(index).copied().unwrap_or_default();
            drawn_kg += channel.tick(self.time_us, coils, reaching);
        }
        let tick_s = TICK_US as f64 * 1e-6;
        // Written so that NaN is 0.
        let speed = if drive.pump > 0.0 { drive.pump.min(1.0) } else { 0.0 };
        self.source.step(drawn_kg, speed, tick_s);
        self.air_used_kg += drawn_kg;
        self.gripper.step(drive.gripper_on);
        self.time_us += TICK_US;
        self.supply_sensor.follow(self.source.abs_pa() - self.ambient_abs_pa, tick_s);
        self.sample();
    }

    /// Plant time, us: the end of the last tick.
    pub fn time_us(&self) -> u64 {
        self.time_us
    }

    /// Converter codes of the channels' pressure sensors at the end of the last tick.
    pub fn pressure_codes(&self) -> &[u16] {
        &self.pressure_codes
    }

    /// Converter code of the supply's pressure sensor at the end of the last tick.
    pub fn supply_code(&self) -> u16 {
        self.supply_code
    }

    /// The true state; solves the shape of every actuator, so call it as often as shapes are
    /// needed and not more.
    pub fn truth(&self) -> Truth {
        Truth {
            time_us: self.time_us,
            supply_pressure_pa: self.source.abs_pa() - self.ambient_abs_pa,
            air_used_kg: self.air_used_kg,
            gripper_closure: self.gripper.closure(),
            channels: self.channels.iter().map(Channel::truth).collect(),
        }
    }

    /// Breaks a part from the next tick on.
    ///
    /// # Errors
    /// When there is no such channel or the leak is out of range.
    pub fn inject(&mut self, channel: usize, fault: ChannelFault) -> Result<(), PlantError> {
        crate::check::check_fault(channel, &fault, self.channels.len())?;
        self.channels[channel].break_part(fault, self.room_k);
        Ok(())
    }

    /// Repairs every part of a channel.
    ///
    /// # Errors
    /// When there is no such channel.
    pub fn repair(&mut self, channel: usize) -> Result<(), PlantError> {
        let channels = self.channels.len();
        let part = self.channels.get_mut(channel).ok_or(PlantError::NoSuchChannel { channel, channels })?;
        part.repair(self.room_k);
        Ok(())
    }

    fn break_due_parts(&mut self) {
        while let Some(due) = self.pending_faults.pop_if(|fault| fault.time_us <= self.time_us) {
            if let Some(channel) = self.channels.get_mut(due.channel) {
                channel.break_part(due.fault, self.room_k);
            }
        }
    }

    fn sample(&mut self) {
        for (code, channel) in self.pressure_codes.iter_mut().zip(&mut self.channels) {
            *code = channel.code();
        }
        self.supply_code = self.supply_sensor.sample(&mut self.random);
    }
}
