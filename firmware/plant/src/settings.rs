//! Plant settings: plain data with nominal values, checked once by
//! [`Plant::new`](crate::Plant::new). Pressures are gauge unless the name says `abs`.

use fra_model::{ActuatorParameters, Fiber, Load, State};

/// The whole plant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantSettings {
    /// Seed of the true parameters of the parts.
    pub seed: u64,
    /// Seed of the variation from run to run: valve jitter, sensor noise.
    pub noise_seed: u64,
    /// Absolute ambient pressure, Pa; 50e3..=120e3.
    pub atmosphere_pa: f64,
    /// Temperature of the room, walls, lines and supply air, K; 250..=330.
    pub temperature_k: f64,
    /// Longest integration step while air is flowing, us; 1..=1000.
    pub step_us: u32,
    /// The air supply shared by all channels.
    pub supply: Supply,
    /// The sensor on the supply.
    pub supply_sensor: SensorSettings,
    /// The voltage of the coils and of the pump.
    pub valve_supply: ValveSupplySettings,
    /// Deviation of the true parameters from the nominal ones.
    pub spread: Spread,
    /// Time that the gripper takes to close, and to open, s; 0..=10.
    pub gripper_time_s: f64,
    /// One entry per pneumatic channel; 1..=64.
    pub channels: Vec<ChannelSettings>,
}

impl PlantSettings {
    /// A nominal plant around `channels`; `seed` decides everything random.
    pub fn new(seed: u64, channels: Vec<ChannelSettings>) -> Self {
        Self {
            seed,
            noise_seed: seed,
            atmosphere_pa: 101_325.0,
            temperature_k: 293.15,
            step_us: 100,
            supply: Supply::Pump(PumpSettings::default()),
            supply_sensor: SensorSettings::supply(),
            valve_supply: ValveSupplySettings::default(),
            spread: Spread::default(),
            gripper_time_s: 0.3,
            channels,
        }
    }
}

/// The voltage of the coils and of the pump, and the divider at which a converter reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValveSupplySettings {
    /// Nominal voltage, V; 1..=60. No noise, no load.
    pub voltage_v: f64,
    /// Voltage at the converter's full scale, V; 1..=60.
    pub full_scale_v: f64,
    /// Code of the converter at 100 %; 255..=65535.
    pub adc_full_scale: u16,
}

impl ValveSupplySettings {
    /// Code of a share of the nominal voltage.
    pub(crate) fn code(&self, share: f64) -> u16 {
        let full = f64::from(self.adc_full_scale);
        (share * self.voltage_v / self.full_scale_v * full).round().min(full) as u16
    }
}

impl Default for ValveSupplySettings {
    /// 24 V behind 100 and 10 kOhm, on a 12-bit converter of 3.3 V.
    fn default() -> Self {
        Self { voltage_v: 24.0, full_scale_v: 36.3, adc_full_scale: 4_095 }
    }
}

/// Source of the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Supply {
    /// A pressure regulator that holds its pressure whatever is drawn.
    Regulated {
        /// Gauge pressure, Pa; 0..=2e6.
        pressure_pa: f64,
    },
    /// A pump behind a check valve, a reservoir and a relief valve.
    Pump(PumpSettings),
}

/// A diaphragm pump and its reservoir.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PumpSettings {
    /// Flow against no pressure at full speed, in cubic metres of the reference atmosphere
    /// (20 degC, 100 kPa) per second; 0..=1.
    pub free_flow_normal_m3_per_s: f64,
    /// Gauge pressure at which the flow has drooped to zero, Pa; 1e3..=2e6.
    pub stall_pressure_pa: f64,
    /// Reservoir volume, m3; up to 1, at least what the fill valves need (the error says how much).
    pub reservoir_volume_m3: f64,
    /// Gauge pressure in the reservoir at the start, Pa; 0..=2e6.
    pub initial_pressure_pa: f64,
    /// Gauge pressure at which the relief valve cracks, Pa; 1e3..=2e6. Fully open 5 % above.
    pub relief_pressure_pa: f64,
    /// Sonic conductance of the open relief valve, m3/(s Pa); 0..=1e-6.
    pub relief_conductance_m3_per_s_pa: f64,
}

impl Default for PumpSettings {
    /// 6 NL/min, stall at 250 kPa, 1 L charged to 200 kPa, relief at 220 kPa.
    fn default() -> Self {
        Self {
            free_flow_normal_m3_per_s: 1.0e-4,
            stall_pressure_pa: 250e3,
            reservoir_volume_m3: 1.0e-3,
            initial_pressure_pa: 200e3,
            relief_pressure_pa: 220e3,
            relief_conductance_m3_per_s_pa: 1.0e-9,
        }
    }
}

/// Equilibria of an actuator and its second winding without load at gauge pressures that rise from zero, Pa: a state for each, up to the
/// end of the branch. `None` where there is none.
#[derive(Clone, Copy, Debug)]
pub struct ActuatorLaw(pub Equilibria);

/// The function of an [`ActuatorLaw`].
pub type Equilibria = fn(&ActuatorParameters<f64>, Option<&Fiber<f64>>, &[f64]) -> Option<Vec<State<f64>>>;

impl PartialEq for ActuatorLaw {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::fn_addr_eq(self.0, other.0)
    }
}

/// A segment of an actuator that is wound differently along its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentSettings {
    /// The nominal segment; the true one differs by [`Spread`], as all of its actuator do.
    pub actuator: ActuatorParameters<f64>,
    /// A winding beside that of the segment.
    pub second_fiber: Option<Fiber<f64>>,
    /// Equilibria of the true segment where [`fra_model`] does not solve it; without load.
    pub law: Option<ActuatorLaw>,
}

/// One channel: a fill and a vent valve, a tube, an actuator, a pressure sensor at the manifold.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelSettings {
    /// The nominal actuator; the true one differs by [`Spread`].
    pub actuator: ActuatorParameters<f64>,
    /// A winding beside that of the actuator.
    pub second_fiber: Option<Fiber<f64>>,
    /// Equilibria of the true actuator where [`fra_model`] does not solve it; without load.
    pub law: Option<ActuatorLaw>,
    /// Segments of the actuator from the base to the tip, where it is a series. Their equilibria then replace those of the actuator.
    pub segments: Vec<SegmentSettings>,
    /// Constant load on the actuator's end.
    pub load: Load<f64>,
    /// Gauge pressure up to which volume and shape are tabulated, Pa; 1e3..=1e6.
    pub pressure_max_pa: f64,
    /// Volume of the fittings at the actuator, m3; 0..=0.01.
    pub dead_volume_m3: f64,
    /// Heat conductance from the air in the actuator to its wall, W/K; 0..=1e4.
    pub wall_w_per_k: f64,
    /// Volume change that creeps in after a pressure step as a share of the immediate one; 0..=1.
    pub creep_share: f64,
    /// Time constant of the creep, s; 0.01..=1e5.
    pub creep_time_s: f64,
    /// Both valves.
    pub valve: ValveSettings,
    /// The tube from the manifold to the actuator.
    pub tube: TubeSettings,
    /// The pressure sensor.
    pub sensor: SensorSettings,
    /// Sonic conductance of a leak from the actuator to the room, m3/(s Pa); 0..=1e-7.
    pub leak_m3_per_s_pa: f64,
    /// Volume change forced on the actuator by the motion of the limb.
    pub motion: MotionSettings,
}

impl ChannelSettings {
    /// A nominal channel around `actuator`, tabulated up to 200 kPa.
    pub fn new(actuator: ActuatorParameters<f64>) -> Self {
        Self {
            actuator,
            second_fiber: None,
            law: None,
            segments: Vec::new(),
            load: Load::none(),
            pressure_max_pa: 200e3,
            dead_volume_m3: 1.0e-6,
            wall_w_per_k: 0.5,
            creep_share: 0.06,
            creep_time_s: 3.0,
            valve: ValveSettings::default(),
            tube: TubeSettings::default(),
            sensor: SensorSettings::channel(),
            leak_m3_per_s_pa: 0.0,
            motion: MotionSettings::default(),
        }
    }
}

/// An on/off valve, normally closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValveSettings {
    /// Sonic conductance, m3/(s Pa); 1e-11..=1e-7.
    pub conductance_m3_per_s_pa: f64,
    /// Critical pressure ratio; 0..=0.9.
    pub critical_ratio: f64,
    /// From coil on to open, us; 0..=1e5.
    pub on_delay_us: f64,
    /// From coil off to closed, us; 0..=1e5.
    pub off_delay_us: f64,
    /// Largest deviation of one movement from its delay, us; uniform; 0..=1e5.
    pub jitter_us: f64,
}

impl Default for ValveSettings {
    /// A VQ110U: 0.144 dm3/(s bar), b = 0.3, 3.5 ms on, 2 ms off, 0.25 ms jitter either way.
    fn default() -> Self {
        Self {
            conductance_m3_per_s_pa: 1.44e-9,
            critical_ratio: 0.3,
            on_delay_us: 3_500.0,
            off_delay_us: 2_000.0,
            jitter_us: 250.0,
        }
    }
}

/// The tube between manifold and actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeSettings {
    /// Length, m; 0.01..=20.
    pub length_m: f64,
    /// Bore, m; 0.5e-3..=20e-3.
    pub bore_m: f64,
    /// Volume on the manifold's side, where the sensor sits, beside that of the tube, m3; 1e-8..=1e-3.
    pub manifold_volume_m3: f64,
}

impl Default for TubeSettings {
    /// 1 m of 2.5 mm tube and 1 mL at the manifold.
    fn default() -> Self {
        Self { length_m: 1.0, bore_m: 2.5e-3, manifold_volume_m3: 1.0e-6 }
    }
}

/// A ratiometric pressure sensor and the converter that reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorSettings {
    /// Gauge pressure at 10 % of full scale, Pa.
    pub min_pa: f64,
    /// Gauge pressure at 90 % of full scale, Pa; above `min_pa`.
    pub max_pa: f64,
    /// First-order lag, s; 0..=1.
    pub lag_s: f64,
    /// Standard deviation of the noise of one sample, Pa; 0..=1e5.
    pub noise_pa: f64,
    /// Code of the converter at 100 %; 255..=65535.
    pub adc_full_scale: u16,
}

impl SensorSettings {
    /// The 30 psi sensor of a channel on a 12-bit converter.
    pub fn channel() -> Self {
        Self { min_pa: 0.0, max_pa: 206_843.0, lag_s: 1.0e-3, noise_pa: 60.0, adc_full_scale: 4_095 }
    }

    /// The 100 psi sensor of the supply on a 12-bit converter.
    pub fn supply() -> Self {
        Self { max_pa: 689_476.0, noise_pa: 200.0, ..Self::channel() }
    }
}

/// A periodic change of the actuator's volume, near to a sine: the effect of moving neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionSettings {
    /// Amplitude, m3; up to a quarter of the volume at rest; 0 is none.
    pub amplitude_m3: f64,
    /// Frequency, Hz; 0..=20.
    pub frequency_hz: f64,
}

/// Standard deviations of the true parameters about the nominal ones, drawn independently for
/// each channel and truncated at three. Relative and 0..=0.3 unless the name says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// All elastic coefficients of the wall together.
    pub modulus: f64,
    /// Wall thickness, at an unchanged inner radius.
    pub wall_thickness: f64,
    /// Fiber angle, rad; 0..=0.1.
    pub fiber_angle_rad: f64,
    /// Gas volume of the actuator.
    pub volume: f64,
    /// Volume of the fittings.
    pub dead_volume: f64,
    /// Sonic conductance of each valve.
    pub valve_conductance: f64,
    /// Each delay of each valve.
    pub valve_delay: f64,
    /// Sensor offset as a share of the sensor's span; 0..=0.1.
    pub sensor_offset: f64,
    /// Sensor gain.
    pub sensor_gain: f64,
}

impl Spread {
    /// A plant whose parameters are exactly the nominal ones.
    pub const NONE: Self = Self {
        modulus: 0.0,
        wall_thickness: 0.0,
        fiber_angle_rad: 0.0,
        volume: 0.0,
        dead_volume: 0.0,
        valve_conductance: 0.0,
        valve_delay: 0.0,
        sensor_offset: 0.0,
        sensor_gain: 0.0,
    };
}

impl Default for Spread {
    /// Workshop tolerances: see `docs/explanation/plant.md` for where each one comes from.
    fn default() -> Self {
        Self {
            modulus: 0.05,
            wall_thickness: 0.02,
            fiber_angle_rad: 0.009,
            volume: 0.03,
            dead_volume: 0.2,
            valve_conductance: 0.07,
            valve_delay: 0.08,
            sensor_offset: 0.003,
            sensor_gain: 0.002,
        }
    }
}
