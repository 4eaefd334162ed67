//! The plant: all channels on one supply, one tick at a time.

use crate::channel::Channel;
use crate::check::{check, check_fault};
use crate::error::PlantError;
use crate::fault::PartFault;
use crate::gripper::Gripper;
use crate::random::Random;
use crate::sensor::Sensor;
use crate::settings::{PlantSettings, ValveSupplySettings};
use crate::spread::calibration;
use crate::supply::Source;
use crate::truth::{Snapshot, Truth};
use crate::valve::Coils;

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

impl ChannelDrive {
    /// The same with the coils exchanged.
    pub(crate) fn swapped(self) -> Self {
        Self { fill_us: self.vent_us, vent_us: self.fill_us }
    }
}

/// Faults that belong to no channel, or to two.
#[derive(Clone, Debug, Default)]
struct Broken {
    /// State in which the supply's valve is stuck.
    supply_open: Option<bool>,
    /// Lost share of the pump's flow.
    pump_missing: f64,
    /// Lost share of the converter's reference.
    reference_missing: f64,
    /// Lost share of the voltage of the valves' supply.
    voltage_missing: f64,
    /// Channels whose sensor is exchanged with the next one's.
    swapped: Vec<usize>,
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
    valve_supply: ValveSupplySettings,
    valve_supply_code: u16,
    /// The valve that lets the supply in is open; it follows its coil without delay.
    is_supply_open: bool,
    /// Codes of the converter at 100 %, of the channels and of the supply.
    full_scales: Vec<u16>,
    supply_full_scale: u16,
    air_used_kg: f64,
    ambient_abs_pa: f64,
    room_k: f64,
    broken: Broken,
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
        let mut plant = Self {
            time_us: 0,
            source: Source::new(settings),
            pressure_codes: vec![0; channels.len()],
            channels,
            supply_sensor: Sensor::new(settings.supply_sensor, offset, gain),
            gripper: Gripper::new(settings.gripper_time_s),
            random,
            supply_code: 0,
            valve_supply: settings.valve_supply,
            valve_supply_code: 0,
            is_supply_open: false,
            full_scales: settings.channels.iter().map(|channel| channel.sensor.adc_full_scale).collect(),
            supply_full_scale: settings.supply_sensor.adc_full_scale,
            air_used_kg: 0.0,
            ambient_abs_pa: settings.atmosphere_pa,
            room_k: settings.temperature_k,
            broken: Broken::default(),
        };
        plant.supply_sensor.settle(plant.source.abs_pa() - plant.ambient_abs_pa);
        plant.sample();
        Ok(plant)
    }

    /// Advances by one tick of [`TICK_US`].
    pub fn step(&mut self, drive: &Drive<'_>) {
        let supply = self.source.abs_pa();
        let voltage = 1.0 - self.broken.voltage_missing;
        let coils = Coils::at(voltage);
        self.is_supply_open = drive.supply_open && coils.act(self.is_supply_open);
        let reaching = self.broken.supply_open.unwrap_or(self.is_supply_open).then_some(supply);
        let mut drawn_kg = 0.0;
        for (index, channel) in self.channels.iter_mut().enumerate() {
            let outputs = drive.channels.get(index).copied().unwrap_or_default();
            drawn_kg += channel.tick(self.time_us, outputs, coils, reaching);
        }
        let tick_s = TICK_US as f64 * 1e-6;
        // Written so that NaN is 0.
        let speed = if drive.pump > 0.0 { drive.pump.min(1.0) } else { 0.0 };
        self.source.step(drawn_kg, speed * voltage * (1.0 - self.broken.pump_missing), tick_s);
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

    /// Converter code of the voltage of the valves' supply at the end of the last tick.
    pub fn valve_supply_code(&self) -> u16 {
        self.valve_supply_code
    }

    /// The true state; finds the shape of every actuator, so call it as often as shapes are
    /// needed and not more.
    pub fn truth(&self) -> Truth {
        let mut snapshot = Snapshot::default();
        self.snapshot(&mut snapshot);
        self.truth_of(&snapshot)
    }

    /// Writes the state of now over another, for [`truth_of`](Self::truth_of) later.
    pub fn snapshot(&self, into: &mut Snapshot) {
        into.time_us = self.time_us;
        into.supply_pressure_pa = self.source.abs_pa() - self.ambient_abs_pa;
        into.air_used_kg = self.air_used_kg;
        into.gripper_closure = self.gripper.closure();
        into.channels.clear();
        into.channels.extend(self.channels.iter().map(Channel::snapshot));
    }

    /// The true state at the time of a snapshot of this plant.
    pub fn truth_of(&self, snapshot: &Snapshot) -> Truth {
        let channels = self.channels.iter().zip(&snapshot.channels);
        Truth {
            time_us: snapshot.time_us,
            supply_pressure_pa: snapshot.supply_pressure_pa,
            air_used_kg: snapshot.air_used_kg,
            gripper_closure: snapshot.gripper_closure,
            channels: channels.map(|(channel, then)| channel.truth_of(then)).collect(),
        }
    }

    /// Breaks a part from the next tick on. `channel` is ignored for a fault of no channel.
    ///
    /// # Errors
    /// When there is no such channel or no such part, or the fault is out of range.
    pub fn inject(&mut self, channel: usize, fault: PartFault) -> Result<(), PlantError> {
        self.can_break(channel, &fault)?;
        match fault {
            PartFault::SupplyStuckOpen => self.broken.supply_open = Some(true),
            PartFault::SupplyStuckClosed => self.broken.supply_open = Some(false),
            PartFault::PumpWeak { share } => self.broken.pump_missing = 1.0 - share,
            PartFault::ReferenceSag { share } => self.broken.reference_missing = share,
            PartFault::ValveSupplySag { share } => self.broken.voltage_missing = share,
            PartFault::SensorsSwapped => self.broken.swapped.push(channel),
            _ => self.channels[channel].break_part(fault, self.room_k),
        }
        Ok(())
    }

    /// Whether the plant has the part of a fault.
    ///
    /// # Errors
    /// As [`inject`](Self::inject).
    pub fn can_break(&self, channel: usize, fault: &PartFault) -> Result<(), PlantError> {
        let has_pump = matches!(self.source, Source::Reservoir(_));
        check_fault(channel, fault, self.channels.len(), has_pump)
    }

    /// Highest gauge pressure of each chamber since the start, Pa.
    pub fn peak_chamber_pa(&self) -> Vec<f64> {
        self.channels.iter().map(Channel::peak_pa).collect()
    }

    /// True gauge pressure of each chamber now, Pa: that of [`truth`](Self::truth), without its shapes.
    pub fn chamber_pa(&self) -> impl Iterator<Item = f64> {
        self.channels.iter().map(Channel::chamber_pa)
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

    fn sample(&mut self) {
        for (code, channel) in self.pressure_codes.iter_mut().zip(&mut self.channels) {
            *code = channel.code();
        }
        self.supply_code = self.supply_sensor.sample(&mut self.random);
        self.valve_supply_code = self.valve_supply.code(1.0 - self.broken.voltage_missing);
        let count = self.pressure_codes.len();
        for &channel in &self.broken.swapped {
            self.pressure_codes.swap(channel, (channel + 1) % count);
        }
        if self.broken.reference_missing > 0.0 {
            let scales = self.full_scales.iter().zip(&mut self.pressure_codes);
            let all = scales.chain([
                (&self.supply_full_scale, &mut self.supply_code),
                (&self.valve_supply.adc_full_scale, &mut self.valve_supply_code),
            ]);
            for (&full_scale, code) in all {
                *code = raised(*code, self.broken.reference_missing).min(full_scale);
            }
        }
    }
}

/// The code of the same voltage after the reference has lost the share `missing`.
fn raised(code: u16, missing: f64) -> u16 {
    (f64::from(code) / (1.0 - missing)).round() as u16
}
