//! One channel over one tick: valves, gas, sensor, creep.

use fra_model::State;

use crate::actuator::TrueActuator;
use crate::curve::VolumeCurve;
use crate::error::PlantError;
use crate::fault::PartFault;
use crate::gas::{Orifice, tube_conductance};
use crate::plant::{ChannelDrive, TICK_US};
use crate::pneumatics::{Gas, Openings, Piping};
use crate::random::Random;
use crate::sensor::Sensor;
use crate::settings::{ChannelSettings, MotionSettings, PlantSettings, ValveSettings};
use crate::spread::TrueParameters;
use crate::truth::{ChannelSnapshot, ChannelTruth};
use crate::valve::{Coils, Valve};

const S_PER_US: f64 = 1e-6;
const TICK_S: f64 = TICK_US as f64 * S_PER_US;

/// The faults that act on a channel now.
#[derive(Clone, Copy, Debug, Default)]
struct Broken {
    stuck_open: Openings,
    stuck_closed: Openings,
    coils_swapped: bool,
    sensor_open: bool,
    /// Code that the sensor repeats.
    sensor_code: Option<u16>,
    sensor_hose_off: bool,
    sensor_drift_pa_per_s: f64,
}

/// One channel.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    parameters: TrueParameters,
    actuator: TrueActuator,
    piping: Piping,
    gas: Gas,
    fill: Valve,
    vent: Valve,
    sensor: Sensor,
    random: Random,
    broken: Broken,
    last_code: u16,
    /// Highest gauge pressure at the end of a tick so far.
    peak_pa: f64,
    intact_leak_m3_per_s_pa: f64,
    intact_tube: Orifice,
    motion: MotionSettings,
    creep_share: f64,
    creep_time_s: f64,
    creep_m3: f64,
    step_us: u64,
}

impl Channel {
    /// Draws the true channel `index` and builds it at rest.
    pub(crate) fn new(plant: &PlantSettings, index: usize) -> Result<Self, PlantError> {
        let nominal = &plant.channels[index];
        let stream = 2 * (index as u64 + 1);
        let mut draw = Random::new(plant.seed, stream);
        let parameters = TrueParameters::draw(nominal, &plant.spread, &mut draw);
        let actuator = TrueActuator::new(index, nominal, &parameters)?;
        let volume = actuator
            .volume_curve(parameters.volume_scale, parameters.dead_volume_m3)
            .ok_or(PlantError::NoEquilibrium { channel: index, pressure_pa: nominal.pressure_max_pa })?;
        let least = 4.0 * nominal.motion.amplitude_m3;
        if volume.rest_volume_m3() < least {
            return Err(PlantError::OutOfRange {
                field: format!("channels[{index}].motion.amplitude_m3"),
                value: nominal.motion.amplitude_m3,
                allowed: format!("at most {:e} m3", volume.rest_volume_m3() / 4.0),
            });
        }
        let piping = piping(plant, nominal, &parameters, volume);
        let valve = |v: &ValveSettings| Valve::new(v.on_delay_us, v.off_delay_us, v.jitter_us);
        Ok(Self {
            gas: Gas::at_rest(&piping),
            fill: valve(&parameters.fill),
            vent: valve(&parameters.vent),
            sensor: Sensor::new(nominal.sensor, parameters.sensor_offset_pa, parameters.sensor_gain),
            random: Random::new(plant.noise_seed, stream + 1),
            broken: Broken::default(),
            last_code: 0,
            peak_pa: 0.0,
            intact_tube: piping.tube,
            intact_leak_m3_per_s_pa: nominal.leak_m3_per_s_pa,
            motion: nominal.motion,
            creep_share: nominal.creep_share,
            creep_time_s: nominal.creep_time_s,
            creep_m3: 0.0,
            step_us: u64::from(plant.step_us),
            parameters,
            actuator,
            piping,
        })
    }

    /// Advances by one tick that starts at `start_us`, against a supply held at `supply_abs_pa`,
    /// or shut off. Returns the air drawn from the supply, kg.
    pub(crate) fn tick(&mut self, start_us: u64, drive: ChannelDrive, coils: Coils, supply_abs_pa: Option<f64>) -> f64 {
        let drawn_before = self.gas.filled_kg;
        let end = start_us + TICK_US;
        let drive = if self.broken.coils_swapped { drive.swapped() } else { drive };
        let fill_off = start_us + u64::from(drive.fill_us).min(TICK_US);
        let vent_off = start_us + u64::from(drive.vent_us).min(TICK_US);
        self.move_limb(start_us);
        let mut now = start_us;
        while now < end {
            let fills = now < fill_off && coils.act(self.fill.is_open());
            let vents = now < vent_off && coils.act(self.vent.is_open());
            self.fill.set_coil(now, fills, &mut self.random);
            self.vent.set_coil(now, vents, &mut self.random);
            let next = [fill_off, vent_off, self.fill.due_us(), self.vent.due_us()]
                .into_iter()
                .filter(|&edge| edge > now)
                .fold(end, u64::min);
            self.flow(next - now, supply_abs_pa);
            now = next;
        }
        self.peak_pa = self.peak_pa.max(self.chamber_pa());
        self.creep();
        self.sensor.drift(self.broken.sensor_drift_pa_per_s * TICK_S);
        self.gas.filled_kg - drawn_before
    }

    /// The code of the converter now.
    pub(crate) fn code(&mut self) -> u16 {
        // The noise is drawn either way, so that a broken wire changes no other number.
        let code = self.sensor.sample(&mut self.random);
        self.last_code = match self.broken.sensor_code {
            _ if self.broken.sensor_open => 0,
            Some(repeated) => repeated,
            None => code,
        };
        self.last_code
    }

    /// Breaks a part of the channel. A fault of no channel changes nothing here.
    pub(crate) fn break_part(&mut self, fault: PartFault, room_k: f64) {
        match fault {
            PartFault::FillStuckOpen => self.broken.stuck_open.fill = true,
            PartFault::VentStuckOpen => self.broken.stuck_open.vent = true,
            PartFault::FillStuckClosed => self.broken.stuck_closed.fill = true,
            PartFault::VentStuckClosed => self.broken.stuck_closed.vent = true,
            PartFault::CoilsSwapped => self.broken.coils_swapped = true,
            PartFault::SensorOpen => self.broken.sensor_open = true,
            PartFault::SensorFrozen => self.broken.sensor_code = Some(self.last_code),
            PartFault::SensorZero => self.broken.sensor_hose_off = true,
            PartFault::SensorDrift { pa_per_s } => self.broken.sensor_drift_pa_per_s = pa_per_s,
            PartFault::HoseKinked { share } => self.piping.tube = self.intact_tube.scaled(share),
            PartFault::Leak { conductance_m3_per_s_pa } => {
                let total = self.intact_leak_m3_per_s_pa + conductance_m3_per_s_pa;
                self.piping.leak = leak(total, room_k);
            }
            PartFault::SensorsSwapped
            | PartFault::SupplyStuckOpen
            | PartFault::SupplyStuckClosed
            | PartFault::PumpWeak { .. }
            | PartFault::ReferenceSag { .. }
            | PartFault::ValveSupplySag { .. } => {}
        }
    }

    /// Repairs every part of the channel. A sensor that has drifted stays where it is.
    pub(crate) fn repair(&mut self, room_k: f64) {
        self.broken = Broken::default();
        self.piping.leak = leak(self.intact_leak_m3_per_s_pa, room_k);
        self.piping.tube = self.intact_tube;
    }

    /// Highest gauge pressure of the chamber at the end of a tick so far, Pa.
    pub(crate) fn peak_pa(&self) -> f64 {
        self.peak_pa
    }

    /// Gauge pressure in the actuator, Pa.
    pub(crate) fn chamber_pa(&self) -> f64 {
        self.gas.chamber_abs_pa - self.piping.ambient_abs_pa
    }

    /// The changing part of the true state.
    pub(crate) fn snapshot(&self) -> ChannelSnapshot {
        ChannelSnapshot { gas: self.gas, creep_m3: self.creep_m3, open: self.openings() }
    }

    /// True state of the channel at the time of a snapshot.
    pub(crate) fn truth_of(&self, then: &ChannelSnapshot) -> ChannelTruth {
        // Of all that is read here, nothing changes during a run.
        let ambient = self.piping.ambient_abs_pa;
        let pressure_pa = then.gas.chamber_abs_pa - ambient;
        let crept = self.piping.volume.at(pressure_pa).0 + then.creep_m3;
        let deforming_pa = self.piping.volume.pressure_of(crept);
        let (mut shape, within_branch) = self.actuator.shape(deforming_pa);
        shape.pressure_pa = pressure_pa;
        let segments = self.actuator.segment_shapes(deforming_pa);
        ChannelTruth {
            pressure_pa,
            line_pressure_pa: then.gas.line_abs_pa - ambient,
            air_used_kg: then.gas.filled_kg,
            air_temperature_k: then.gas.temperature_k(&self.piping),
            fill_open: then.open.fill,
            vent_open: then.open.vent,
            shape,
            segments: segments.map(|segment| State { pressure_pa, ..segment }).collect(),
            within_branch,
            parameters: self.parameters.clone(),
        }
    }

    fn openings(&self) -> Openings {
        let Broken { stuck_open, stuck_closed, .. } = self.broken;
        Openings {
            fill: stuck_open.fill || self.fill.is_open() && !stuck_closed.fill,
            vent: stuck_open.vent || self.vent.is_open() && !stuck_closed.vent,
        }
    }

    /// Integrates over a span in which no valve moves.
    fn flow(&mut self, span_us: u64, supply_abs_pa: Option<f64>) {
        let mut open = self.openings();
        open.fill &= supply_abs_pa.is_some();
        let supply = supply_abs_pa.unwrap_or(self.piping.ambient_abs_pa);
        let mut left = span_us;
        while left > 0 {
            let quiet = open == Openings::default() && self.gas.is_settled();
            let step = if quiet { left } else { left.min(self.step_us) };
            let h_s = step as f64 * S_PER_US;
            self.gas.step(&self.piping, open, supply, h_s);
            let line_pa = self.gas.line_abs_pa - self.piping.ambient_abs_pa;
            self.sensor.follow(if self.broken.sensor_hose_off { 0.0 } else { line_pa }, h_s);
            left -= step;
        }
    }

    fn move_limb(&mut self, now_us: u64) {
        if self.motion.amplitude_m3 > 0.0 {
            let turns = self.motion.frequency_hz * now_us as f64 * S_PER_US;
            let displaced_m3 = self.motion.amplitude_m3 * wave(turns);
            self.gas.displace(&self.piping, displaced_m3);
        }
    }

    /// `tau dV_creep/dt = share (V - V_0) - V_creep`, implicit over the tick.
    fn creep(&mut self) {
        let gauge_pa = self.gas.chamber_abs_pa - self.piping.ambient_abs_pa;
        let volume = &self.piping.volume;
        let goal = self.creep_share * (volume.at(gauge_pa).0 - volume.rest_volume_m3());
        self.creep_m3 += (goal - self.creep_m3) * TICK_S / (self.creep_time_s + TICK_S);
    }
}

/// A sine made of two parabolas, within 6 % of one: no transcendental function, hence the same
/// bits on every platform.
fn wave(turns: f64) -> f64 {
    let phase = 2.0 * (turns - turns.floor()) - 1.0;
    -4.0 * phase * (1.0 - phase.abs())
}

fn leak(conductance: f64, room_k: f64) -> Option<Orifice> {
    (conductance > 0.0).then(|| Orifice::new(conductance, 0.3, room_k))
}

fn piping(plant: &PlantSettings, nominal: &ChannelSettings, true_one: &TrueParameters, volume: VolumeCurve) -> Piping {
    let room_k = plant.temperature_k;
    let tube = nominal.tube;
    let (conductance, critical_ratio) = tube_conductance(tube.length_m, tube.bore_m);
    let bore_area = core::f64::consts::FRAC_PI_4 * tube.bore_m * tube.bore_m;
    let orifice = |v: &ValveSettings| Orifice::new(v.conductance_m3_per_s_pa, v.critical_ratio, room_k);
    Piping {
        fill: orifice(&true_one.fill),
        vent: orifice(&true_one.vent),
        tube: Orifice::new(conductance, critical_ratio, room_k),
        leak: leak(nominal.leak_m3_per_s_pa, room_k),
        line_volume_m3: bore_area * tube.length_m + tube.manifold_volume_m3,
        wall_w_per_k: nominal.wall_w_per_k,
        ambient_abs_pa: plant.atmosphere_pa,
        room_k,
        volume,
    }
}
