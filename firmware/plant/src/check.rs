//! One look at the settings; afterwards nothing re-checks them.

use core::ops::RangeInclusive;

use crate::error::PlantError;
use crate::fault::PartFault;
use crate::settings::{ChannelSettings, PlantSettings, PumpSettings, SensorSettings, Spread, Supply};
use crate::supply::RELIEF_BAND;

type Checked = Result<(), PlantError>;

/// Steepest chord of an orifice, at equal pressures, in units of its choked flow per pressure.
const STEEPEST: f64 = 25.0;
/// `1 / (2 tick rho0 R T0)`, 1/(s Pa): a flow of `C rho0 p` moves the pressure of the volume
/// `C / MOST_RATE` by `p/2` in one tick. Supply pressure is held over a tick, so no flow may do more.
const MOST_RATE: f64 = 1.0 / (2.0 * 1e-3 * 1e5);

/// Checks every field that does not need the model.
pub(crate) fn check(settings: &PlantSettings) -> Checked {
    within("atmosphere_pa", settings.atmosphere_pa, 50e3..=120e3)?;
    within("temperature_k", settings.temperature_k, 250.0..=330.0)?;
    within("step_us", f64::from(settings.step_us), 1.0..=1e3)?;
    within("channels.len()", settings.channels.len() as f64, 1.0..=64.0)?;
    match &settings.supply {
        Supply::Regulated { pressure_pa } => within("supply.pressure_pa", *pressure_pa, 0.0..=2e6)?,
        Supply::Pump(pump) => check_pump(pump, least_reservoir_m3(settings))?,
    }
    check_sensor("supply_sensor", &settings.supply_sensor)?;
    let valve_supply = &settings.valve_supply;
    let voltages = [
        ("voltage_v", valve_supply.voltage_v, 1.0..=60.0),
        ("full_scale_v", valve_supply.full_scale_v, 1.0..=60.0),
        ("adc_full_scale", f64::from(valve_supply.adc_full_scale), 255.0..=65_535.0),
    ];
    within_all("valve_supply", voltages)?;
    check_spread(&settings.spread)?;
    within("gripper_time_s", settings.gripper_time_s, 0.0..=10.0)?;
    for (index, channel) in settings.channels.iter().enumerate() {
        check_channel(&format!("channels[{index}]"), channel)?;
        let refuse = |source| PlantError::Actuator { channel: index, source };
        channel.actuator.check().map_err(refuse)?;
        channel.segments.iter().try_for_each(|segment| segment.actuator.check()).map_err(refuse)?;
    }
    Ok(())
}

/// Checks a fault against the number of channels and the kind of the supply.
pub(crate) fn check_fault(channel: usize, fault: &PartFault, channels: usize, has_pump: bool) -> Checked {
    if fault.is_of_channel() && channel >= channels {
        return Err(PlantError::NoSuchChannel { channel, channels });
    }
    match *fault {
        PartFault::Leak { conductance_m3_per_s_pa: c } => within("fault.conductance_m3_per_s_pa", c, 0.0..=1e-7),
        PartFault::HoseKinked { share } | PartFault::PumpWeak { share } if !(0.0..=1.0).contains(&share) => {
            within("fault.share", share, 0.0..=1.0)
        }
        PartFault::PumpWeak { .. } if !has_pump => Err(PlantError::NoPump),
        PartFault::SensorDrift { pa_per_s } => within("fault.pa_per_s", pa_per_s, -1e5..=1e5),
        PartFault::SensorsSwapped => within("channels.len()", channels as f64, 2.0..=64.0),
        PartFault::ReferenceSag { share } => within("fault.share", share, 0.0..=0.5),
        PartFault::ValveSupplySag { share } => within("fault.share", share, 0.0..=1.0),
        _ => Ok(()),
    }
}

/// The smallest reservoir for these fill valves.
fn least_reservoir_m3(settings: &PlantSettings) -> f64 {
    let fill: f64 = settings.channels.iter().map(|channel| channel.valve.conductance_m3_per_s_pa).sum();
    STEEPEST * fill / MOST_RATE
}

fn check_pump(pump: &PumpSettings, least_m3: f64) -> Checked {
    let volume = pump.reservoir_volume_m3;
    let (stall, relief) = (pump.stall_pressure_pa, pump.relief_pressure_pa);
    let most_flow = (MOST_RATE * volume * stall).min(1.0);
    // Slope of the relief flow within the band in which it opens.
    let relief_slope = RELIEF_BAND * relief / (relief + 120e3);
    let most_relief = MOST_RATE * volume * relief_slope.min(1.0 / STEEPEST);
    let initial = pump.initial_pressure_pa;
    let ranges = [
        ("stall_pressure_pa", stall, 1e3..=2e6),
        ("relief_pressure_pa", relief, 1e3..=2e6),
        ("reservoir_volume_m3", volume, least_m3.max(1e-5)..=1.0),
        ("initial_pressure_pa", initial, 0.0..=2e6),
        ("free_flow_normal_m3_per_s", pump.free_flow_normal_m3_per_s, 0.0..=most_flow),
        ("relief_conductance_m3_per_s_pa", pump.relief_conductance_m3_per_s_pa, 0.0..=most_relief),
    ];
    within_all("supply", ranges)
}

fn check_sensor(path: &str, sensor: &SensorSettings) -> Checked {
    let full_scale = f64::from(sensor.adc_full_scale);
    let ranges = [
        ("min_pa", sensor.min_pa, -200e3..=1e7),
        ("max_pa", sensor.max_pa, sensor.min_pa + 1e3..=1e7),
        ("lag_s", sensor.lag_s, 0.0..=1.0),
        ("noise_pa", sensor.noise_pa, 0.0..=1e5),
        ("adc_full_scale", full_scale, 255.0..=65_535.0),
    ];
    within_all(path, ranges)
}

fn check_spread(spread: &Spread) -> Checked {
    let ranges = [
        ("modulus", spread.modulus, 0.0..=0.3),
        ("wall_thickness", spread.wall_thickness, 0.0..=0.3),
        ("fiber_angle_rad", spread.fiber_angle_rad, 0.0..=0.1),
        ("volume", spread.volume, 0.0..=0.3),
        ("dead_volume", spread.dead_volume, 0.0..=0.3),
        ("valve_conductance", spread.valve_conductance, 0.0..=0.3),
        ("valve_delay", spread.valve_delay, 0.0..=0.3),
        ("sensor_offset", spread.sensor_offset, 0.0..=0.1),
        ("sensor_gain", spread.sensor_gain, 0.0..=0.3),
    ];
    within_all("spread", ranges)
}

fn check_channel(path: &str, channel: &ChannelSettings) -> Checked {
    let (valve, tube, motion) = (&channel.valve, &channel.tube, &channel.motion);
    let ranges = [
        ("load.force_n", channel.load.force_n, -1e4..=1e4),
        ("load.torque_nm", channel.load.torque_nm, -1e3..=1e3),
        ("pressure_max_pa", channel.pressure_max_pa, 1e3..=1e6),
        ("dead_volume_m3", channel.dead_volume_m3, 0.0..=1e-2),
        ("wall_w_per_k", channel.wall_w_per_k, 0.0..=1e4),
        ("creep_share", channel.creep_share, 0.0..=1.0),
        ("creep_time_s", channel.creep_time_s, 1e-2..=1e5),
        ("leak_m3_per_s_pa", channel.leak_m3_per_s_pa, 0.0..=1e-7),
        ("valve.conductance_m3_per_s_pa", valve.conductance_m3_per_s_pa, 1e-11..=1e-7),
        ("valve.critical_ratio", valve.critical_ratio, 0.0..=0.9),
        ("valve.on_delay_us", valve.on_delay_us, 0.0..=1e5),
        ("valve.off_delay_us", valve.off_delay_us, 0.0..=1e5),
        ("valve.jitter_us", valve.jitter_us, 0.0..=1e5),
        ("tube.length_m", tube.length_m, 0.01..=20.0),
        ("tube.bore_m", tube.bore_m, 0.5e-3..=20e-3),
        ("tube.manifold_volume_m3", tube.manifold_volume_m3, 1e-8..=1e-3),
        ("motion.amplitude_m3", motion.amplitude_m3, 0.0..=1e-2),
        ("motion.frequency_hz", motion.frequency_hz, 0.0..=20.0),
    ];
    within_all(path, ranges)?;
    check_sensor(&format!("{path}.sensor"), &channel.sensor)
}

fn within_all<const N: usize>(path: &str, ranges: [(&str, f64, RangeInclusive<f64>); N]) -> Checked {
    ranges.into_iter().try_for_each(|(field, value, range)| within(&format!("{path}.{field}"), value, range))
}

fn within(field: &str, value: f64, range: RangeInclusive<f64>) -> Checked {
    if range.contains(&value) {
        return Ok(());
    }
    Err(PlantError::OutOfRange {
        field: field.to_owned(),
        value,
        allowed: format!("{:e} to {:e}", range.start(), range.end()),
    })
}
