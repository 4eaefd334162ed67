//! A rig for the link: a simulated device with a few actuators, its configuration, and trajectories.
#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part")]

#[path = "../../../../firmware/sim/tests/common/tables.rs"]
mod tables;

use fra_model::{ActuatorParameters, Material, Motion};
use softlimb_protocol::*;
use softlimb_rig::link::{DeviceConfiguration, Event, Knot};
use softlimb_sim::plant::{ChannelSettings, PlantSettings, Supply};
use softlimb_sim::{SimSettings, SimulatedMcu};

/// Session of the tests.
pub const SESSION: u16 = 0x51AB;

/// Gauge pressure above which a channel is vented, Pa.
pub const PRESSURE_MAX_PA: f32 = 120e3;

/// A bending actuator of about 80 mL.
pub fn actuator() -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        material: Material::NeoHookean { shear_modulus_pa: 0.4e6 },
        fiber: None,
    }
}

/// A device with `channels` such actuators on a regulated supply.
pub fn settings(channels: usize) -> SimSettings {
    let mut plant = PlantSettings::new(7, vec![ChannelSettings::new(actuator()); channels]);
    plant.supply = Supply::Regulated { pressure_pa: 200e3 };
    SimSettings::new(plant)
}

pub fn device(settings: &SimSettings) -> SimulatedMcu {
    SimulatedMcu::new(settings).expect("the settings of the rig are good")
}

/// What the device is told about the rig; setpoints are pressures.
pub fn configuration(channels: usize) -> DeviceConfiguration {
    let system = ConfigSystem {
        session: 0,
        telemetry_period_us: 10_000,
        control_period_us: 20_000,
        link_timeout_us: 100_000,
        hold_time_us: 500_000,
        link_loss_policy: LinkLossPolicy::HoldThenRamp.into(),
        vent_ramp_pa_per_s: 20_000.0,
        supply_min_pa: 150e3,
        supply_max_pa: 230e3,
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
    };
    let (volume, _) = tables::tables(&channel()).expect("it bends");
    let volumes = (0..).take(channels).map(|channel| ConfigVolume { channel, ..volume.clone() }).collect();
    DeviceConfiguration { system, channels: vec![channel(); channels], volumes, inverses: Vec::new() }
}

fn channel() -> ConfigChannel {
    ConfigChannel {
        session: 0,
        channel: 0,
        motion: MotionKind::Bending.into(),
        setpoint_kind: SetpointKind::Pressure.into(),
        law: MaterialLaw::NeoHookean.into(),
        families: 0,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        c_pa_1: 0.4e6,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad: 0.0,
        fiber_modulus_pa: 0.0,
        fiber_thickness_m: 0.0,
        fiber_radius_m: 0.0,
        pressure_max_pa: PRESSURE_MAX_PA,
        dead_volume_m3: 6.9e-6,
        setpoint_min: 0,
        setpoint_max: 110_000,
    }
}

/// Knots every 20 ms for `seconds`: from 0 to 30 kPa within a second, then 30 kPa with a different triangle of 10 kPa on each channel.
pub fn knots(channels: usize, seconds: f64) -> Vec<Knot> {
    let count = (seconds * 50.0) as i32;
    let value = |step: i32, channel: i32| {
        let phase = (step + 20 * channel) % 100;
        let triangle = 200 * phase.min(100 - phase);
        (step * 600).min(30_000) + if step > 50 { triangle.min(200 * (step - 50)) } else { 0 }
    };
    (0..=count)
        .map(|step| Knot {
            time_us: step as u64 * 20_000,
            outputs: Outputs::default(),
            values: (0..channels as i32).map(|channel| value(step, channel)).collect(),
        })
        .collect()
}

/// Everything that a run told, by kind.
#[derive(Clone, Debug, Default)]
pub struct Told {
    pub telemetry: Vec<Telemetry>,
    pub faults: Vec<Fault>,
    pub states: Vec<DeviceState>,
    pub start_us: u64,
    pub end_us: u64,
}

impl Told {
    pub fn take(&mut self, event: Event) {
        match event {
            Event::Telemetry { message, .. } => self.telemetry.push(message),
            Event::Fault { message, .. } => self.faults.push(message),
            Event::State(state) => self.states.push(state),
            Event::Armed { start_us, end_us } => (self.start_us, self.end_us) = (start_us, end_us),
            _ => {}
        }
    }

    /// Telemetry of the running device.
    pub fn running(&self) -> impl Iterator<Item = &Telemetry> {
        self.telemetry.iter().filter(|message| message.state == DeviceState::Running)
    }
}

/// The reference of a channel at a time of the run, by the knots alone, Pa.
pub fn reference_pa(knots: &[Knot], channel: usize, time_us: u64) -> f64 {
    let after = knots.partition_point(|knot| knot.time_us <= time_us).clamp(1, knots.len() - 1);
    let (a, b) = (&knots[after - 1], &knots[after]);
    let share = (time_us.min(b.time_us) - a.time_us) as f64 / (b.time_us - a.time_us) as f64;
    f64::from(a.values[channel]) + share * f64::from(b.values[channel] - a.values[channel])
}

/// The loop takes its reference one control period ahead and its telemetry shows the reference of the period's segment: whatever the
/// device tracks must lie between the knots around it.
pub fn assert_tracks_the_knots(told: &Told, knots: &[Knot]) {
    let mut compared = 0;
    for message in told.running().filter(|m| m.time_us > told.start_us + 60_000 && m.time_us < told.end_us) {
        let time_us = message.time_us - told.start_us;
        for (channel, sample) in message.channels.iter().enumerate() {
            let around =
                (0..=5).map(|step| reference_pa(knots, channel, (time_us + step * 10_000).saturating_sub(30_000)));
            let (low, high) = around.fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p), high.max(p)));
            let shown = f64::from(sample.reference_10pa) * 10.0;
            assert!(shown > low - 20.0 && shown < high + 20.0, "{shown} outside {low}..{high} at {time_us}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}
