//! The system of a device on a bench, for every crate that sets one up.

use softlimb_protocol::{ConfigSystem, LinkLossPolicy, PressureLoopKind};

/// Highest pressures of the sensors of the channels and of the supply, gauge Pa.
pub(crate) const SENSOR_MAX_PA: f32 = 206_843.0;
pub(crate) const SUPPLY_SENSOR_MAX_PA: f32 = 689_476.0;

pub(crate) fn system(session: u16) -> ConfigSystem {
    ConfigSystem {
        session,
        telemetry_period_us: 10_000,
        control_period_us: 20_000,
        link_timeout_us: 100_000,
        hold_time_us: 2_000_000,
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
        sensor_max_pa: SENSOR_MAX_PA,
        supply_sensor_min_pa: 0.0,
        supply_sensor_max_pa: SUPPLY_SENSOR_MAX_PA,
        adc_full_scale: 4095,
        pressure_loop: PressureLoopKind::Pulses.into(),
        valve_supply_scale_mv: 36_300,
        valve_supply_min_mv: 20_000,
    }
}
