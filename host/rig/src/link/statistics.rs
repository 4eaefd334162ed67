//! Statistics of the link.

use std::fmt;

use serde::{Deserialize, Serialize};
use softlimb_protocol::{LinkCounters, LinkErrors};

/// Counts since the session was created.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkStatistics {
    /// Frames sent, repetitions included.
    pub frames_sent: u64,
    /// Reliable messages sent again.
    pub messages_repeated: u64,
    /// Setpoints sent again.
    pub setpoints_repeated: u64,
    /// Frames received and rejected, by reason.
    pub received: LinkCounters,
    /// Round trips of heartbeats.
    pub round_trip: RoundTrip,
    /// Errors of the device's serial port; `None` where the device told of none in this session.
    pub port_errors: Option<PortErrors>,
}

/// Serial-port errors since the device started, as in `protocol/SPEC.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PortErrors {
    /// Overrun errors: a byte arrived before the previous one was read.
    pub overrun: u32,
    /// Framing errors: a byte without a stop bit.
    pub framing: u32,
    /// Noise errors: the samples within one bit disagreed.
    pub noise: u32,
    /// Parity errors.
    pub parity: u32,
    /// Intact bytes dropped because the receive queue was full.
    pub queue_full: u32,
}

impl From<&LinkErrors> for PortErrors {
    fn from(message: &LinkErrors) -> Self {
        let LinkErrors { overrun, framing, noise, parity, queue_full } = *message;
        Self { overrun, framing, noise, parity, queue_full }
    }
}

impl fmt::Display for PortErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.overrun, "overrun"),
            (self.framing, "framing"),
            (self.noise, "noise"),
            (self.parity, "parity"),
            (self.queue_full, "queue full"),
        ];
        let told: Vec<String> =
            counts.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{name} {count}")).collect();
        f.write_str(if told.is_empty() { "no error" } else { "" })?;
        f.write_str(&told.join(", "))
    }
}

/// Round-trip times of heartbeats, us.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoundTrip {
    /// Heartbeats answered.
    pub count: u64,
    /// The shortest.
    pub min_us: u64,
    /// The longest.
    pub max_us: u64,
    sum_us: u64,
}

impl RoundTrip {
    /// The mean, us; 0 where there is none.
    #[must_use]
    pub fn mean_us(&self) -> u64 {
        self.sum_us.checked_div(self.count).unwrap_or(0)
    }

    pub(super) fn add(&mut self, round_trip_us: u64) {
        self.min_us = if self.count == 0 { round_trip_us } else { self.min_us.min(round_trip_us) };
        self.max_us = self.max_us.max(round_trip_us);
        self.sum_us += round_trip_us;
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_named_where_there_are_some() {
        assert_eq!(PortErrors::from(&LinkErrors::NONE).to_string(), "no error");
        let all = LinkErrors { overrun: 1, framing: 2, noise: 3, parity: 4, queue_full: 5 };
        assert_eq!(PortErrors::from(&all).to_string(), "overrun 1, framing 2, noise 3, parity 4, queue full 5");
        assert_eq!(PortErrors { noise: 7, ..PortErrors::default() }.to_string(), "noise 7");
    }
}
