//! The device's clock as seen from the host.
//!
//! Each heartbeat exchange says: when the host's clock stood between sending and receiving, the device's showed its time. The
//! shortest round trips say it best: the best exchange of each quarter second is kept, and a line goes through the best quarter of
//! those of the last 16 s.

use std::collections::VecDeque;

/// Time for which only the best exchange is kept, us.
const BUCKET_US: u64 = 250_000;

/// Exchanges kept: 16 s.
const EXCHANGES_MAX: usize = 64;

/// Exchanges that the line goes through at least, where there are so many.
const FIT_MIN: usize = 4;

/// Span of the fitted exchanges from which on they tell the drift: over less, one tick of jitter would be more than any drift, us.
const DRIFT_SPAN_US: f64 = 4e6;

/// Largest drift believed: beyond any oscillator.
const DRIFT_MAX: f64 = 1e-3;

/// One exchange of times.
#[derive(Clone, Copy, Debug)]
struct Exchange {
    sent_us: u64,
    round_trip_us: u64,
    device_us: u64,
}

impl Exchange {
    fn middle_us(&self) -> f64 {
        self.sent_us as f64 + self.round_trip_us as f64 / 2.0
    }
}

/// A straight line between the two clocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockMap {
    host_us: f64,
    device_us: f64,
    drift: f64,
    half_round_trip_us: f64,
}

impl ClockMap {
    /// The device's clock at a time of the host's, us.
    #[must_use]
    pub fn device_us(&self, host_us: u64) -> u64 {
        // The cast saturates: before the start of the device its clock is 0.
        (self.device_us + (host_us as f64 - self.host_us) * (1.0 + self.drift)).round() as u64
    }

    /// The host's clock at a time of the device's, us.
    #[must_use]
    pub fn host_us(&self, device_us: u64) -> u64 {
        (self.host_us + (device_us as f64 - self.device_us) / (1.0 + self.drift)).round() as u64
    }

    /// Relative speed of the device's clock, less one, 1e-6; 0 until the exchanges span a few seconds.
    #[must_use]
    pub fn drift_ppm(&self) -> f64 {
        self.drift * 1e6
    }

    /// Half of the shortest round trip, us: no single exchange can be wrong by more than half of its own.
    #[must_use]
    pub fn half_round_trip_us(&self) -> f64 {
        self.half_round_trip_us
    }
}

/// Collects exchanges and draws the line.
#[derive(Clone, Debug, Default)]
pub(super) struct ClockEstimator {
    best: VecDeque<Exchange>,
    map: Option<ClockMap>,
}

impl ClockEstimator {
    /// Adds an exchange: sent and received by the host's clock, answered by the device's, us.
    pub(super) fn add(&mut self, sent_us: u64, received_us: u64, device_us: u64) {
        let exchange = Exchange { sent_us, round_trip_us: received_us.saturating_sub(sent_us), device_us };
        match self.best.back_mut() {
            Some(last) if last.sent_us / BUCKET_US == sent_us / BUCKET_US => {
                if exchange.round_trip_us < last.round_trip_us {
                    *last = exchange;
                }
            }
            _ => self.best.push_back(exchange),
        }
        if self.best.len() > EXCHANGES_MAX {
            self.best.pop_front();
        }
        self.map = fit(self.best.iter().copied());
    }

    /// The line; `None` before the first exchange.
    pub(super) fn map(&self) -> Option<ClockMap> {
        self.map
    }
}

/// Least squares through the best quarter.
fn fit(exchanges: impl Iterator<Item = Exchange>) -> Option<ClockMap> {
    let mut best: Vec<_> = exchanges.collect();
    best.sort_by_key(|exchange| exchange.round_trip_us);
    best.truncate((best.len() / 4).max(FIT_MIN));
    let origin = *best.first()?;
    let (host_0, device_0) = (origin.middle_us(), origin.device_us as f64);
    // Relative to the best exchange, so that a large epoch costs no digits.
    let points: Vec<_> = best.iter().map(|e| (e.middle_us() - host_0, e.device_us as f64 - device_0)).collect();
    let count = points.len() as f64;
    let (mean_x, mean_y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (variance, covariance) = points.iter().fold((0.0, 0.0), |(v, c), p| {
        let (dx, dy) = (p.0 - mean_x, p.1 - mean_y);
        (v + dx * dx, c + dx * (dy - dx))
    });
    let low = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let drift = if high - low < DRIFT_SPAN_US { 0.0 } else { (covariance / variance).clamp(-DRIFT_MAX, DRIFT_MAX) };
    Some(ClockMap {
        host_us: host_0 + mean_x,
        device_us: device_0 + mean_y,
        drift,
        half_round_trip_us: origin.round_trip_us as f64 / 2.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device that started 7 s before the host's clock and runs `ppm` fast.
    fn device_us(host_us: f64, ppm: f64) -> f64 {
        7e6 + host_us * (1.0 + ppm * 1e-6)
    }

    /// Heartbeats every 25 ms for 20 s; the way there takes 0.3 ms and up to 1 ms of jitter, the way back 0.5 ms; every tenth answer
    /// comes 40 ms late.
    fn estimate(ppm: f64) -> ClockMap {
        let mut estimator = ClockEstimator::default();
        for beat in 0..800_u64 {
            let sent_us = 1_000_000_000 + beat * 25_000;
            let there_us = 300 + beat * 7_919 % 1_000;
            let back_us = if beat % 10 == 3 { 40_000 } else { 500 };
            let answered = device_us((sent_us + there_us) as f64, ppm);
            estimator.add(sent_us, sent_us + there_us + back_us, answered as u64);
        }
        estimator.map().unwrap()
    }

    #[test]
    fn late_answers_and_drift_do_not_mislead() {
        for ppm in [-100.0, 0.0, 250.0] {
            let map = estimate(ppm);
            assert!((map.drift_ppm() - ppm).abs() < 10.0, "{} for {ppm}", map.drift_ppm());
            for host_us in [1_005_000_000_u64, 1_020_000_000, 1_030_000_000] {
                let error = map.device_us(host_us) as f64 - device_us(host_us as f64, ppm);
                assert!(error.abs() < 300.0, "{error} us at {host_us}");
                assert!(map.host_us(map.device_us(host_us)).abs_diff(host_us) <= 1);
            }
        }
    }

    #[test]
    fn first_exchange_gives_the_middle_and_no_drift() {
        let mut estimator = ClockEstimator::default();
        assert_eq!(estimator.map(), None);
        estimator.add(1_000, 3_000, 50_000);
        let map = estimator.map().unwrap();
        assert_eq!((map.device_us(2_000), map.host_us(60_000), map.drift_ppm()), (50_000, 12_000, 0.0));
        assert_eq!(map.half_round_trip_us(), 1_000.0);
    }
}
