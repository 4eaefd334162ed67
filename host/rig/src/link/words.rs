//! Codes and bits of the wire in words.

use std::fmt::Debug;

use softlimb_protocol::{ChannelStatus, Code, CodeSet, FaultCode, Telemetry};

use super::fault;

/// Name of a code, as `protocol/SPEC.md` has it.
#[must_use]
pub fn code_name<T: CodeSet + Debug>(code: Code<T>) -> String {
    code.known().map_or_else(|| format!("unknown code {}", code.raw()), |known| format!("{known:?}"))
}

/// The faults of the bits in Telemetry, in words.
#[must_use]
pub fn fault_names(bits: u16) -> Vec<String> {
    let is_set = |number: &u8| bits & 1 << (number - 1) != 0;
    (1..=16).filter(is_set).map(|number| fault::name(Code::<FaultCode>::from_raw(number))).collect()
}

/// Voltage of the valves' supply, V; `None` if the board does not sense it.
#[must_use]
pub fn valve_supply_v(message: &Telemetry) -> Option<f64> {
    let is_sensed = message.valve_supply_mv != Telemetry::VALVE_SUPPLY_NOT_SENSED;
    is_sensed.then(|| f64::from(message.valve_supply_mv) / 1e3)
}

/// The condition of a channel in words; none where all is well.
#[must_use]
pub fn status_names(status: ChannelStatus) -> Vec<&'static str> {
    let words = [
        (ChannelStatus::SENSOR_IMPLAUSIBLE, "implausible sensor"),
        (ChannelStatus::REFERENCE_LIMITED, "reference limited"),
        (ChannelStatus::INVERSE_FAILED, "deformation out of reach"),
    ];
    words.into_iter().filter(|(bit, _)| status.bits() & bit.bits() != 0).map(|(_, word)| word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_has_its_words() {
        // Bits by the table of the specification: code - 1.
        assert_eq!(fault_names(0b10_0100), ["link lost", "supply pressure too high"]);
        assert_eq!(fault_names(1 << 15), ["unknown fault 16"]);
        assert_eq!(fault_names(0), [""; 0]);
        assert_eq!(status_names(ChannelStatus::from_bits(0b101)), ["implausible sensor", "deformation out of reach"]);
    }
}
