//! Faults of the device in words.

use std::fmt;

use softlimb_protocol::{Code, CodeSet, Fault, FaultCode, SYSTEM_CHANNEL};

/// A fault that the device told of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceFault {
    /// Kind of fault.
    pub code: Code<FaultCode>,
    /// The channel, from 0; `None` for the system, or when only the fault bit arrived.
    pub channel: Option<u8>,
    /// The offending value; `None` when only the fault bit arrived.
    pub value: Option<i32>,
    /// Device time, us; `None` when only the fault bit arrived.
    pub time_us: Option<u64>,
}

impl DeviceFault {
    /// The first fault in `bits` (bit `code - 1`, as in Telemetry) that makes the device stop.
    pub(super) fn from_bits(bits: u16) -> Option<Self> {
        (1..=16)
            .filter_map(FaultCode::from_code)
            .find(|&code| bits & code.bit() != 0 && stops(code.into()))
            .map(|code| Self { code: code.into(), channel: None, value: None, time_us: None })
    }

    /// Whether the device leaves its trajectory because of it.
    pub(super) fn stops_the_device(&self) -> bool {
        stops(self.code)
    }
}

/// A lost link and an empty buffer are states of the link; whether they stopped the device shows in its state.
fn stops(code: Code<FaultCode>) -> bool {
    !matches!(code.known(), Some(FaultCode::LinkLost | FaultCode::SetpointsExhausted))
}

impl From<&Fault> for DeviceFault {
    fn from(fault: &Fault) -> Self {
        Self {
            code: fault.code,
            channel: (fault.channel != SYSTEM_CHANNEL).then_some(fault.channel),
            value: Some(fault.value),
            time_us: Some(fault.time_us),
        }
    }
}

impl fmt::Display for DeviceFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&name(self.code))?;
        if let Some(channel) = self.channel {
            write!(f, " on channel {channel}")?;
        }
        let Some(value) = self.value else { return Ok(()) };
        match self.code.known() {
            Some(
                FaultCode::OverPressure
                | FaultCode::SupplyLow
                | FaultCode::SupplyHigh
                | FaultCode::SensorImplausible
                | FaultCode::InverseFailed
                | FaultCode::SensorFrozen
                | FaultCode::ReadingJumped
                | FaultCode::FillWithoutEffect
                | FaultCode::ExcessAir
                | FaultCode::MissingAir,
            ) => {
                // Adding zero turns the -0.0 of a small negative value into 0.0.
                write!(f, " at {:.1} kPa", (f64::from(value) * 1e-2).round() / 10.0 + 0.0)
            }
            Some(FaultCode::ValveSupplyLow) => write!(f, " at {:.1} V", f64::from(value) * 1e-3),
            Some(FaultCode::LinkLost | FaultCode::TickOverrun) => write!(f, " for {:.1} ms", f64::from(value) * 1e-3),
            Some(FaultCode::SetpointsExhausted) => write!(f, " at knot {value}"),
            Some(FaultCode::EmergencyStop) | None => Ok(()),
        }
    }
}

/// The fault in words.
pub(super) fn name(code: Code<FaultCode>) -> String {
    let words = match code.known() {
        Some(FaultCode::SensorImplausible) => "implausible pressure sensor",
        Some(FaultCode::OverPressure) => "over-pressure",
        Some(FaultCode::LinkLost) => "link lost",
        Some(FaultCode::SetpointsExhausted) => "no setpoints left",
        Some(FaultCode::SupplyLow) => "supply pressure too low",
        Some(FaultCode::SupplyHigh) => "supply pressure too high",
        Some(FaultCode::ValveSupplyLow) => "voltage of the valves' supply too low",
        Some(FaultCode::EmergencyStop) => "emergency stop",
        Some(FaultCode::InverseFailed) => "deformation out of reach",
        Some(FaultCode::TickOverrun) => "late control tick",
        Some(FaultCode::SensorFrozen) => "frozen pressure sensor",
        Some(FaultCode::ReadingJumped) => {
            "fall of a reading without venting (hose off the sensor, sensors exchanged, vent open, or a burst)"
        }
        Some(FaultCode::FillWithoutEffect) => {
            "filling without effect (fill valve or supply closed, vent open, hose kinked, coils exchanged, or sensor wrong)"
        }
        Some(FaultCode::ExcessAir) => {
            "more air than the valves explain (fill valve open, vent closed, coils exchanged, hose kinked, or sensor wrong)"
        }
        Some(FaultCode::MissingAir) => {
            "less air than the valves explain (vent open, leak or burst, fill valve or supply closed, hose kinked, or sensor wrong)"
        }
        None => return format!("unknown fault {}", code.raw()),
    };
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fault_says_what_where_and_how_much() {
        let fault = Fault { time_us: 5, channel: 3, code: FaultCode::OverPressure.into(), value: 151_240 };
        assert_eq!(DeviceFault::from(&fault).to_string(), "over-pressure on channel 3 at 151.2 kPa");
        let at_rest = Fault { value: -30, ..fault.clone() };
        assert_eq!(DeviceFault::from(&at_rest).to_string(), "over-pressure on channel 3 at 0.0 kPa");
        let system = Fault { channel: SYSTEM_CHANNEL, code: FaultCode::EmergencyStop.into(), ..fault.clone() };
        assert_eq!(DeviceFault::from(&system).to_string(), "emergency stop");
        let volts = Fault { code: FaultCode::ValveSupplyLow.into(), value: 19_989, ..system };
        assert_eq!(DeviceFault::from(&volts).to_string(), "voltage of the valves' supply too low at 20.0 V");
    }

    #[test]
    fn bits_of_the_link_alone_are_no_reason_to_stop() {
        let bits = |codes: &[FaultCode]| codes.iter().fold(0, |bits, code| bits | code.bit());
        assert_eq!(DeviceFault::from_bits(bits(&[FaultCode::LinkLost, FaultCode::SetpointsExhausted])), None);
        let fault = DeviceFault::from_bits(bits(&[FaultCode::LinkLost, FaultCode::SupplyLow])).unwrap();
        assert_eq!(fault.code, FaultCode::SupplyLow);
    }
}
