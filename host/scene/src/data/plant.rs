//! The pneumatics.

/// The pneumatics: nominal values, and the spread of the simulated truth about them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Plant {
    /// The air around.
    pub ambient: Ambient,
    /// Source of compressed air.
    pub supply: Supply,
    /// The fill and the vent valve of a channel.
    pub valve: Valve,
    /// The tube from the valves to an actuator.
    pub line: Line,
    /// Properties of a chamber beyond its geometry.
    pub chamber: Chamber,
    /// Pressure sensors.
    pub sensor: Sensor,
    /// Deviation of the simulated truth from the nominal values.
    pub spread: Spread,
    /// The simulated limb.
    pub truth: TrueLimb,
}

/// The simulated limb.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrueLimb {
    /// The planner's kinematics and statics, with perturbed parameters.
    #[default]
    Simple,
    /// Tubes with memory between plates.
    Body(BodyEffects),
}

/// Effects of a limb of tubes beside that of being one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyEffects {
    /// Loops that do not depend on the rate.
    pub hysteresis: bool,
    /// Creep and damping.
    pub creep: bool,
    /// Softening in the first cycles.
    pub softening: bool,
    /// Tolerances of tubes, connectors and base.
    pub assembly: bool,
    /// Obstacles stop the limb and what it carries; `false` without obstacles.
    pub contact: bool,
    /// Inertia, with the damping of the tubes.
    pub swing: bool,
}

impl TrueLimb {
    /// The limb in the words of a table; `None` for the simple one.
    pub fn label(&self) -> Option<String> {
        let Self::Body(BodyEffects { hysteresis, creep, softening, assembly, contact, swing }) = *self else {
            return None;
        };
        let effects = [
            (hysteresis, "hysteresis"),
            (creep, "creep"),
            (softening, "softening"),
            (assembly, "assembly"),
            (contact, "contact"),
            (swing, "swing"),
        ];
        let words = effects.into_iter().filter_map(|(on, word)| on.then_some(word));
        Some(std::iter::once("body").chain(words).collect::<Vec<_>>().join(" + "))
    }
}

/// The air around.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ambient {
    /// Absolute pressure, Pa.
    pub pressure_pa: f64,
    /// Temperature, K.
    pub temperature_k: f64,
}

/// Source of compressed air. Pressures are gauge.
#[derive(Clone, Debug, PartialEq)]
pub enum Supply {
    /// A pump that fills a reservoir.
    Pump {
        /// Pressure to which the reservoir is charged when the run starts, Pa.
        pressure_pa: f64,
        /// Flow without back pressure, m3/s at the reference atmosphere (1.185 kg/m3).
        flow_m3_per_s: f64,
        /// Pressure at which the pump delivers nothing, Pa; >= `pressure_pa`.
        stall_pressure_pa: f64,
        /// Volume of the reservoir, m3.
        reservoir_volume_m3: f64,
    },
    /// A source of constant pressure.
    Regulated {
        /// Its pressure, Pa.
        pressure_pa: f64,
    },
}

impl Supply {
    /// The pressure with which the run starts, Pa gauge.
    pub fn pressure_pa(&self) -> f64 {
        match *self {
            Self::Pump { pressure_pa, .. } | Self::Regulated { pressure_pa } => pressure_pa,
        }
    }
}

/// A valve, by ISO 6358.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Valve {
    /// Sonic conductance C, m3/(s Pa).
    pub conductance_m3_per_s_pa: f64,
    /// Critical pressure ratio b.
    pub critical_ratio: f64,
    /// From coil on to open, s.
    pub on_delay_s: f64,
    /// From coil off to closed, s.
    pub off_delay_s: f64,
    /// Standard deviation of each delay from one switching to the next, s; the distribution is uniform.
    pub jitter_s: f64,
    /// Conductance of the closed valve, m3/(s Pa).
    pub leak_m3_per_s_pa: f64,
    /// Nominal voltage of the coils and of their supply, V.
    pub voltage_v: f64,
}

/// The tube from the valves to an actuator.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Line {
    /// Length, m.
    pub length_m: f64,
    /// Inner diameter, m.
    pub inner_diameter_m: f64,
}

/// Properties of a chamber beyond its geometry.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Chamber {
    /// Volume of fittings, without the line, m3.
    pub dead_volume_m3: f64,
    /// Heat conductance from the air to the wall, W/K.
    pub wall_heat_w_per_k: f64,
    /// Share of a deformation that follows slowly.
    pub creep_share: f64,
    /// Time constant of that share, s.
    pub creep_time_s: f64,
}

/// Pressure sensors, ratiometric: 10 % of the output at 0, 90 % at full scale.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sensor {
    /// Gauge pressure at 90 % of the output of a channel's sensor, Pa.
    pub full_scale_pa: f64,
    /// The same of the supply's sensor, Pa.
    pub supply_full_scale_pa: f64,
    /// Resolution of the converter, bits; 8 to 16.
    pub bits: u8,
    /// Standard deviation of one sample, Pa.
    pub noise_pa: f64,
    /// Time constant, s.
    pub lag_s: f64,
}

impl Sensor {
    /// Largest code of the converter.
    pub fn adc_full_scale(&self) -> u16 {
        u16::MAX >> (16 - self.bits.clamp(8, 16))
    }
}

/// Standard deviations of the true values about the nominal ones, drawn once per channel and cut at three standard deviations.
/// Relative where they have no unit; that of the sensor's offset is relative to full scale.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spread {
    /// Moduli of the elastomer.
    pub modulus: f64,
    /// Wall thickness.
    pub wall: f64,
    /// Fiber angle, rad.
    pub fiber_angle_rad: f64,
    /// Dead volume.
    pub dead_volume: f64,
    /// Sonic conductance of each valve.
    pub valve_conductance: f64,
    /// Delays of each valve.
    pub valve_delay: f64,
    /// Offset of a sensor, of full scale.
    pub sensor_offset: f64,
    /// Gain of a sensor.
    pub sensor_gain: f64,
}
