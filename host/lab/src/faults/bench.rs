//! The limb of the matrix: three extending actuators of 30, 80 and 150 mL, and their configuration.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb_protocol::{
    ConfigChannel, ConfigSystem, FiberPlacement, LinkLossPolicy, MaterialLaw, MotionKind, PressureLoopKind,
    SetpointKind,
};
use softlimb_rig::link::{DeviceConfiguration, Knot, Outputs};
use softlimb_sim::SimSettings;
use softlimb_sim::plant::{ChannelSettings, PlantSettings};

use super::LIMIT_PA;

/// Volumes at rest, m3.
pub(crate) const VOLUMES_M3: [f64; CHANNELS] = [30e-6, 80e-6, 150e-6];
pub(crate) const CHANNELS: usize = 3;

pub(crate) const KNOT_US: u64 = 20_000;
/// End, s: a turning point of the sine. The reference stands still there, so the timing of the last pulse hardly changes the held pressure.
const END_S: f64 = 8.66;

const INNER_M: f64 = 15e-3;
const OUTER_M: f64 = 20e-3;
const MODULUS_PA: f64 = 0.4e6;
const FIBER: Fiber<f64> = Fiber {
    families: Families::Two,
    placement: Placement::Sheet,
    angle_rad: 0.05,
    modulus_pa: 361e6,
    thickness_m: 0.178e-3,
    radius_m: OUTER_M,
};

fn length_m(volume_m3: f64) -> f64 {
    volume_m3 / (std::f64::consts::PI * INNER_M * INNER_M)
}

/// The plant of a seed.
pub(crate) fn settings(seed: u64) -> SimSettings {
    let channels = VOLUMES_M3.map(|volume_m3| {
        let actuator = ActuatorParameters {
            motion: Motion::Extension,
            inner_radius_m: INNER_M,
            outer_radius_m: OUTER_M,
            length_m: length_m(volume_m3),
            material: Material::NeoHookean { shear_modulus_pa: MODULUS_PA },
            fiber: Some(FIBER),
        };
        ChannelSettings { pressure_max_pa: 1.4 * LIMIT_PA, ..ChannelSettings::new(actuator) }
    });
    SimSettings { seed, ..SimSettings::new(PlantSettings::new(seed, channels.to_vec())) }
}

/// What the device is told of it: the nominal values, and pressures as setpoints.
pub(crate) fn configuration() -> DeviceConfiguration {
    let channels = VOLUMES_M3.iter().zip(0..).map(|(volume_m3, channel)| ConfigChannel {
        session: 0,
        channel,
        motion: MotionKind::Extension.into(),
        setpoint_kind: SetpointKind::Pressure.into(),
        law: MaterialLaw::NeoHookean.into(),
        families: 2,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: INNER_M as f32,
        outer_radius_m: OUTER_M as f32,
        length_m: length_m(*volume_m3) as f32,
        c_pa_1: MODULUS_PA as f32,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad: FIBER.angle_rad as f32,
        fiber_modulus_pa: FIBER.modulus_pa as f32,
        fiber_thickness_m: FIBER.thickness_m as f32,
        fiber_radius_m: FIBER.radius_m as f32,
        pressure_max_pa: LIMIT_PA as f32,
        dead_volume_m3: 6.9e-6,
        setpoint_min: 0,
        setpoint_max: 140_000,
    });
    DeviceConfiguration { system: system(), channels: channels.collect(), volumes: Vec::new(), inverses: Vec::new() }
}

fn system() -> ConfigSystem {
    ConfigSystem {
        session: 0,
        telemetry_period_us: 10_000,
        control_period_us: 20_000,
        link_timeout_us: 200_000,
        hold_time_us: 2_000_000,
        link_loss_policy: LinkLossPolicy::HoldThenRamp.into(),
        vent_ramp_pa_per_s: 20e3,
        supply_min_pa: 100e3,
        supply_max_pa: 240e3,
        atmosphere_pa: 101_325.0,
        temperature_k: 293.15,
        valve_conductance_m3_per_s_pa: 1.44e-9,
        valve_critical_ratio: 0.3,
        valve_on_delay_us: 3_500,
        valve_off_delay_us: 2_000,
        line_conductance_m3_per_s_pa: 3.78e-9,
        sensor_min_pa: 0.0,
        sensor_max_pa: 206_843.0,
        supply_sensor_min_pa: 0.0,
        supply_sensor_max_pa: 689_476.0,
        adc_full_scale: 4095,
        pressure_loop: PressureLoopKind::Pulses.into(),
        valve_supply_scale_mv: 36_300,
        valve_supply_min_mv: 20_000,
    }
}

/// Reference, Pa: a fill to near the limit, a hold, a fall, a hold, and a sine.
fn reference_pa(time_s: f64) -> f64 {
    let ramp = |from_s: f64, to_s: f64| ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
    let sine = if time_s > 5.0 { 30e3 * (3.0 * (time_s - 5.0)).sin() } else { 0.0 };
    5e3 + 130e3 * ramp(0.5, 1.5) - 70e3 * ramp(3.5, 4.5) + sine
}

/// The reference as knots, the same for all channels.
pub(super) fn knots() -> Vec<Knot> {
    let times = (0..).map(|index| index * KNOT_US).take_while(|time_us| *time_us as f64 * 1e-6 <= END_S);
    let value = |time_us: u64| reference_pa(time_us as f64 * 1e-6) as i32;
    times.map(|time_us| Knot { time_us, outputs: Outputs::default(), values: vec![value(time_us); CHANNELS] }).collect()
}
