//! Times from an order to its setpoint on the wire.

use std::fmt;
use std::time::Duration;

use serde::Serialize;

/// Percentiles of some times, ms.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Latency {
    p50_ms: f64,
    p99_ms: f64,
    max_ms: f64,
}

impl Latency {
    /// Of times in any order; `None` of none.
    pub(super) fn of(mut waits: Vec<Duration>) -> Option<Self> {
        waits.sort_unstable();
        let at = |share: f64| {
            let rank = (share * waits.len() as f64).ceil() as usize;
            waits.get(rank.saturating_sub(1)).map(|wait| 1e3 * wait.as_secs_f64())
        };
        Some(Self { p50_ms: at(0.5)?, p99_ms: at(0.99)?, max_ms: at(1.0)? })
    }
}

impl fmt::Display for Latency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "p50 {:.1}, p99 {:.1}, max {:.1} ms", self.p50_ms, self.p99_ms, self.max_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_rank() {
        let waits: Vec<Duration> = (1..=200).rev().map(Duration::from_millis).collect();
        let expected = Latency { p50_ms: 100.0, p99_ms: 198.0, max_ms: 200.0 };
        assert_eq!(Latency::of(waits), Some(expected));
        assert_eq!(Latency::of(Vec::new()), None);
    }
}
