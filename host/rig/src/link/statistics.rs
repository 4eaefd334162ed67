//! Statistics of the link.

use softlimb_protocol::LinkCounters;

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
