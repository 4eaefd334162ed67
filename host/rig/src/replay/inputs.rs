//! Inputs of each tick: those of the log, or an approximation from a device's measurements.

use softlimb_protocol::{ConfigSystem, DeviceMessage, HostMessage, MAX_CHANNELS, Telemetry};
use softlimb_sim::{AdcCode, TickInputs};

use super::frames::Framed;
use crate::record::{Capture, DeviceTick};

/// Inputs in order of time.
pub(super) struct Inputs<'a> {
    ticks: &'a [DeviceTick],
    /// Place in `ticks` behind the present tick.
    next: usize,
    /// Measurements in order, and the scale of the sensors, for a device that does not show its ticks.
    measured: Vec<&'a Telemetry>,
    scale: Option<Scale>,
}

impl<'a> Inputs<'a> {
    pub(super) fn new(capture: &'a Capture, told: &[Framed<HostMessage>], heard: &'a [Framed<DeviceMessage>]) -> Self {
        let measured = heard.iter().filter_map(|frame| match &frame.message {
            DeviceMessage::Telemetry(telemetry) => Some(telemetry),
            _ => None,
        });
        let scale = told.iter().rev().find_map(|frame| match &frame.message {
            HostMessage::ConfigSystem(system) => Some(Scale::of(system)),
            _ => None,
        });
        Self { ticks: &capture.ticks, next: 0, measured: measured.collect(), scale }
    }

    /// Inputs of the tick at a device time, later than that of the last call; `None` where the log has a gap.
    pub(super) fn at(&mut self, now_us: u64) -> Option<TickInputs> {
        if self.ticks.is_empty() {
            return Some(self.near(now_us));
        }
        let tick = self.ticks.get(self.next).filter(|tick| tick.device_us == now_us)?;
        self.next += 1;
        let (supply, channels) = tick.codes.split_last()?;
        let mut pressure = [AdcCode(0); MAX_CHANNELS];
        pressure.iter_mut().zip(channels).for_each(|(place, &code)| *place = AdcCode(code));
        Some(TickInputs { now_us, pressure, supply: AdcCode(*supply), emergency_stop: tick.stop_pressed })
    }

    /// The tick of the log that the last inputs were taken from.
    pub(super) fn tick(&self) -> Option<&'a DeviceTick> {
        self.ticks.get(self.next.checked_sub(1)?)
    }

    /// The measurement at a time or before, as codes.
    fn near(&mut self, now_us: u64) -> TickInputs {
        while self.measured.get(self.next + 1).is_some_and(|telemetry| telemetry.time_us <= now_us) {
            self.next += 1;
        }
        let silent =
            TickInputs { now_us, pressure: [AdcCode(0); MAX_CHANNELS], supply: AdcCode(0), emergency_stop: false };
        let (Some(telemetry), Some(scale)) = (self.measured.get(self.next), self.scale) else { return silent };
        let mut pressure = [AdcCode(0); MAX_CHANNELS];
        for (place, channel) in pressure.iter_mut().zip(telemetry.channels.iter()) {
            *place = code(channel.pressure_10pa, scale.sensor, scale.full_scale);
        }
        TickInputs { pressure, supply: code(telemetry.supply_10pa, scale.supply, scale.full_scale), ..silent }
    }
}

/// Scales of the sensors: gauge pressures at 10 % and 90 %, Pa, and the code of 100 %.
#[derive(Debug, Clone, Copy)]
struct Scale {
    sensor: (f32, f32),
    supply: (f32, f32),
    full_scale: u16,
}

impl Scale {
    fn of(system: &ConfigSystem) -> Self {
        Self {
            sensor: (system.sensor_min_pa, system.sensor_max_pa),
            supply: (system.supply_sensor_min_pa, system.supply_sensor_max_pa),
            full_scale: system.adc_full_scale,
        }
    }
}

/// The code of a pressure: 10 % of the full scale at the one end, 90 % at the other.
fn code(pressure_10pa: u16, (min_pa, max_pa): (f32, f32), full_scale: u16) -> AdcCode {
    let share = 0.1 + 0.8 * (10.0 * f32::from(pressure_10pa) - min_pa) / (max_pa - min_pa);
    // The cast saturates.
    AdcCode((share * f32::from(full_scale)).round() as u16)
}
