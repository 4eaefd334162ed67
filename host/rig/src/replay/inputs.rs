//! Inputs of each tick: those of the log, or an approximation from a device's measurements.

use softlimb_protocol::{ConfigSystem, DeviceMessage, HostMessage, MAX_CHANNELS, Telemetry, TickFlags};
use softlimb_sim::{AdcCode, TickInputs};

use super::frames::Framed;
use crate::record::DeviceTick;

/// Origin of the converter codes of a re-run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Codes {
    /// A simulated or emulated device shows its ticks, from the first one on, with their outputs.
    Shown,
    /// A device behind a port has sent them, from its configuration on.
    Sent,
    /// The log has none.
    Unknown,
}

impl Codes {
    pub(super) fn are_known(self) -> bool {
        self != Self::Unknown
    }
}

/// The ticks that a device has sent.
pub(super) fn sent(heard: &[Framed<DeviceMessage>]) -> Vec<DeviceTick> {
    let messages = heard.iter().filter_map(|frame| match &frame.message {
        DeviceMessage::Ticks(message) => Some(message),
        _ => None,
    });
    let ticks = messages.flat_map(|message| {
        (0..).zip(message.ticks.iter()).map(|(index, tick)| DeviceTick {
            device_us: message.time_us.saturating_add(1_000 * index),
            codes: tick.codes.iter().copied().chain([tick.supply_code]).collect(),
            valve_supply_code: tick.valve_supply_code,
            stop_pressed: tick.flags.contains(TickFlags::EMERGENCY_STOP),
            // The outputs are a checksum, which is compared as a part of the message.
            supply_open: false,
            pump_duty: 0,
            outputs: 0,
            pulses: Vec::new(),
        })
    });
    ticks.collect()
}

/// Inputs in order of time.
pub(super) struct Inputs<'a> {
    codes: Codes,
    ticks: &'a [DeviceTick],
    /// Place in `ticks` behind the present tick.
    next: usize,
    /// Measurements in order, and the scale of the sensors, for a device that does not show its ticks.
    measured: Vec<&'a Telemetry>,
    scale: Option<Scale>,
}

impl<'a> Inputs<'a> {
    pub(super) fn new(
        (codes, ticks): (Codes, &'a [DeviceTick]),
        told: &[Framed<HostMessage>],
        heard: &'a [Framed<DeviceMessage>],
    ) -> Self {
        let measured = heard.iter().filter_map(|frame| match &frame.message {
            DeviceMessage::Telemetry(telemetry) => Some(telemetry),
            _ => None,
        });
        let scale = told.iter().rev().find_map(|frame| match &frame.message {
            HostMessage::ConfigSystem(system) => Some(Scale::of(system)),
            _ => None,
        });
        Self { codes, ticks, next: 0, measured: measured.collect(), scale }
    }

    /// Inputs of the tick at a device time, later than that of the last call; `None` where the log has a gap.
    pub(super) fn at(&mut self, now_us: u64) -> Option<TickInputs> {
        match self.codes {
            Codes::Unknown => return Some(self.near(now_us)),
            // A device without a configuration reads no converter.
            Codes::Sent if self.ticks.first().is_some_and(|first| now_us < first.device_us) => {
                return Some(silent(now_us));
            }
            Codes::Shown | Codes::Sent => {}
        }
        let tick = self.ticks.get(self.next).filter(|tick| tick.device_us == now_us)?;
        self.next += 1;
        let (supply, channels) = tick.codes.split_last()?;
        let mut pressure = [AdcCode(0); MAX_CHANNELS];
        pressure.iter_mut().zip(channels).for_each(|(place, &code)| *place = AdcCode(code));
        let (supply, valve_supply) = (AdcCode(*supply), AdcCode(tick.valve_supply_code));
        Some(TickInputs { now_us, pressure, supply, valve_supply, emergency_stop: tick.stop_pressed })
    }

    /// The tick of the log that the last inputs were taken from, with its outputs.
    pub(super) fn shown(&self) -> Option<&'a DeviceTick> {
        self.ticks.get(self.next.checked_sub(1)?).filter(|_| self.codes == Codes::Shown)
    }

    /// The measurement at a time or before, as codes.
    fn near(&mut self, now_us: u64) -> TickInputs {
        while self.measured.get(self.next + 1).is_some_and(|telemetry| telemetry.time_us <= now_us) {
            self.next += 1;
        }
        let (Some(telemetry), Some(scale)) = (self.measured.get(self.next), self.scale) else { return silent(now_us) };
        let mut pressure = [AdcCode(0); MAX_CHANNELS];
        for (place, channel) in pressure.iter_mut().zip(telemetry.channels.iter()) {
            *place = code(channel.pressure_10pa, scale.sensor, scale.full_scale);
        }
        let supply = code(telemetry.supply_10pa, scale.supply, scale.full_scale);
        let valve_supply = scale.valve_supply(telemetry.valve_supply_mv);
        TickInputs { pressure, supply, valve_supply, ..silent(now_us) }
    }
}

/// Inputs of a device that reads nothing.
fn silent(now_us: u64) -> TickInputs {
    let (pressure, none) = ([AdcCode(0); MAX_CHANNELS], AdcCode(0));
    TickInputs { now_us, pressure, supply: none, valve_supply: none, emergency_stop: false }
}

/// Scales of the sensors: gauge pressures at 10 % and 90 %, Pa, the voltage at 100 %, mV, and the code of 100 %.
#[derive(Debug, Clone, Copy)]
struct Scale {
    sensor: (f32, f32),
    supply: (f32, f32),
    valve_supply_mv: u16,
    full_scale: u16,
}

impl Scale {
    fn of(system: &ConfigSystem) -> Self {
        Self {
            sensor: (system.sensor_min_pa, system.sensor_max_pa),
            supply: (system.supply_sensor_min_pa, system.supply_sensor_max_pa),
            valve_supply_mv: system.valve_supply_scale_mv,
            full_scale: system.adc_full_scale,
        }
    }

    /// A code that reads as this voltage of the valves' supply; any where it is not sensed.
    fn valve_supply(&self, millivolts: u16) -> AdcCode {
        let parts = u32::from(millivolts) * u32::from(self.full_scale);
        // The cast saturates at none: a voltage is at most the full scale.
        AdcCode(parts.div_ceil(u32::from(self.valve_supply_mv.max(1))).min(u32::from(u16::MAX)) as u16)
    }
}

/// The code of a pressure: 10 % of the full scale at the one end, 90 % at the other.
fn code(pressure_10pa: u16, (min_pa, max_pa): (f32, f32), full_scale: u16) -> AdcCode {
    let share = 0.1 + 0.8 * (10.0 * f32::from(pressure_10pa) - min_pa) / (max_pa - min_pa);
    // The cast saturates.
    AdcCode((share * f32::from(full_scale)).round() as u16)
}
