//! The part of the configuration that all channels share.

use softlimb_protocol::{Code, ConfigSystem, LinkLossPolicy, PressureLoopKind};

use super::{ConfigError, known, number, within};
use crate::flow::Orifice;
use crate::gas::Absolute;
use crate::pneumatics::Pneumatics;
use crate::sensor::{SensorScale, VoltageScale};
use crate::valve::{TICK_US, ValveTiming};

/// Highest voltage of the valves' supply at the converter's full scale, mV: below the value that says "not sensed".
const VALVE_SUPPLY_MAX_MV: u16 = 60_000;

/// Timing, limits, air path and sensors of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SystemConfig {
    /// Time between two Telemetry messages, us.
    pub telemetry_period_us: u32,
    /// Ticks in one control period.
    pub control_period_ticks: u32,
    /// Silence after which the link counts as lost, us.
    pub link_timeout_us: u32,
    /// Time from holding to ramping down, us.
    pub hold_time_us: u32,
    /// Reaction to link loss; one that is known.
    pub link_loss_policy: Code<LinkLossPolicy>,
    /// Slope of the ramp down, Pa/s.
    pub vent_ramp_pa_per_s: f32,
    /// Lowest supply pressure for running, gauge Pa.
    pub supply_min_pa: f32,
    /// Highest supply pressure, gauge Pa; within the range of the supply sensor.
    pub supply_max_pa: f32,
    /// Air path.
    pub pneumatics: Pneumatics,
    /// Sensors of the channels.
    pub sensor: SensorScale,
    /// Sensor of the supply.
    pub supply_sensor: SensorScale,
    /// Divider at the valves' supply.
    pub valve_supply: VoltageScale,
    /// Lowest voltage of the valves' supply, mV; 0 if it is not watched.
    pub valve_supply_min_mv: u16,
    /// Highest gauge pressure that the channel sensors measure, Pa.
    pub sensor_max_pa: f32,
    /// How pressures follow their references in Running; one that is known.
    pub pressure_loop: Code<PressureLoopKind>,
}

impl SystemConfig {
    /// Length of the control period, us.
    pub fn control_period_us(&self) -> u32 {
        self.control_period_ticks * TICK_US
    }
}

impl TryFrom<&ConfigSystem> for SystemConfig {
    type Error = ConfigError;

    fn try_from(wire: &ConfigSystem) -> Result<Self, ConfigError> {
        let supply_min_pa = within(number!(ConfigSystem, "supply_min_pa"), wire.supply_min_pa, 0.0..=1e6)?;
        let sensor_min_pa = within(number!(ConfigSystem, "sensor_min_pa"), wire.sensor_min_pa, -2e5..=1e6)?;
        let supply_sensor_min_pa =
            within(number!(ConfigSystem, "supply_sensor_min_pa"), wire.supply_sensor_min_pa, -2e5..=1e6)?;
        let full_scale = within(number!(ConfigSystem, "adc_full_scale"), wire.adc_full_scale, 255..=u16::MAX)?;
        let sensor_max_pa = above(number!(ConfigSystem, "sensor_max_pa"), wire.sensor_max_pa, sensor_min_pa)?;
        let supply_sensor_max_pa =
            above(number!(ConfigSystem, "supply_sensor_max_pa"), wire.supply_sensor_max_pa, supply_sensor_min_pa)?;
        let valve_supply_mv = within(
            number!(ConfigSystem, "valve_supply_scale_mv"),
            wire.valve_supply_scale_mv,
            0..=VALVE_SUPPLY_MAX_MV,
        )?;
        Ok(Self {
            telemetry_period_us: within(
                number!(ConfigSystem, "telemetry_period_us"),
                wire.telemetry_period_us,
                TICK_US..=10_000_000,
            )?,
            control_period_ticks: control_period(wire.control_period_us)?,
            link_timeout_us: within(
                number!(ConfigSystem, "link_timeout_us"),
                wire.link_timeout_us,
                10 * TICK_US..=10_000_000,
            )?,
            hold_time_us: within(number!(ConfigSystem, "hold_time_us"), wire.hold_time_us, 0..=600_000_000)?,
            link_loss_policy: known(number!(ConfigSystem, "link_loss_policy"), wire.link_loss_policy)?.into(),
            vent_ramp_pa_per_s: within(
                number!(ConfigSystem, "vent_ramp_pa_per_s"),
                wire.vent_ramp_pa_per_s,
                100.0..=1e6,
            )?,
            supply_min_pa,
            supply_max_pa: within(
                number!(ConfigSystem, "supply_max_pa"),
                wire.supply_max_pa,
                supply_min_pa + 100.0..=supply_sensor_max_pa,
            )?,
            pneumatics: pneumatics(wire)?,
            sensor: SensorScale::new(sensor_min_pa, sensor_max_pa, full_scale),
            supply_sensor: SensorScale::new(supply_sensor_min_pa, supply_sensor_max_pa, full_scale),
            valve_supply: VoltageScale::new(valve_supply_mv, full_scale),
            // A voltage that is not sensed cannot be watched.
            valve_supply_min_mv: within(
                number!(ConfigSystem, "valve_supply_min_mv"),
                wire.valve_supply_min_mv,
                0..=valve_supply_mv,
            )?,
            sensor_max_pa,
            pressure_loop: known(number!(ConfigSystem, "pressure_loop"), wire.pressure_loop)?.into(),
        })
    }
}

fn pneumatics(wire: &ConfigSystem) -> Result<Pneumatics, ConfigError> {
    let conductance = within(
        number!(ConfigSystem, "valve_conductance_m3_per_s_pa"),
        wire.valve_conductance_m3_per_s_pa,
        1e-11..=1e-6,
    )?;
    let critical_ratio = within(number!(ConfigSystem, "valve_critical_ratio"), wire.valve_critical_ratio, 0.0..=0.9)?;
    let line =
        within(number!(ConfigSystem, "line_conductance_m3_per_s_pa"), wire.line_conductance_m3_per_s_pa, 1e-11..=1e-5)?;
    let atmosphere_pa = within(number!(ConfigSystem, "atmosphere_pa"), wire.atmosphere_pa, 5e4..=1.2e5)?;
    let temperature_k = within(number!(ConfigSystem, "temperature_k"), wire.temperature_k, 250.0..=350.0)?;
    let timing = ValveTiming {
        on_delay_us: within(number!(ConfigSystem, "valve_on_delay_us"), wire.valve_on_delay_us, 0..=20_000)?,
        off_delay_us: within(number!(ConfigSystem, "valve_off_delay_us"), wire.valve_off_delay_us, 0..=20_000)?,
    };
    let valve = Orifice::new(conductance, critical_ratio);
    Ok(Pneumatics::new(valve, Orifice::line(line), Absolute::new(atmosphere_pa), temperature_k, timing))
}

/// Whole ticks, 10 to 100: shorter periods leave no time to settle between pulses.
fn control_period(period_us: u32) -> Result<u32, ConfigError> {
    let field = number!(ConfigSystem, "control_period_us");
    within(field, period_us % TICK_US, 0..=0)?;
    Ok(within(field, period_us, 10 * TICK_US..=100 * TICK_US)? / TICK_US)
}

/// At least 100 Pa above the lower end, at most 2 MPa.
fn above(field: u8, value_pa: f32, lower_pa: f32) -> Result<f32, ConfigError> {
    within(field, value_pa, lower_pa + 100.0..=2e6)
}
