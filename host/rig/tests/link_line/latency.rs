//! Time from the hand-over of a set point to its acceptance, when a host sends each as it is made.

use super::observed::Observed;
use super::percentile_ms;
use crate::link_common::{SESSION, configuration, settings};
use softlimb_numerics::Random;
use softlimb_protocol::Outputs;
use softlimb_rig::link::{Knot, LinkFaults, Pilot, StreamOptions, Wish, live};

const CHANNELS: usize = 9;

/// Duration of the session, us.
const END_US: u64 = 60_000_000;

/// A hand that moves on, and presses keys at random times.
struct Hand {
    /// Mean time from key to key, us; without keys none.
    pause_us: Option<f64>,
    key_us: u64,
    pauses: Random,
}

impl Pilot for Hand {
    fn look(&mut self, now_us: u64) -> Wish {
        if now_us >= END_US {
            return Wish::End;
        }
        match self.pause_us {
            Some(pause_us) if now_us >= self.key_us => {
                self.key_us = now_us + (self.pauses.uniform() * 2.0 * pause_us) as u64;
                Wish::Move
            }
            _ => Wish::Nothing,
        }
    }

    fn knot(&mut self, time_us: u64) -> Knot {
        let value = (time_us / 1_000 % 20_000) as i32;
        Knot { time_us, outputs: Outputs::default(), values: vec![value; CHANNELS] }
    }

    fn sent(&mut self, _now_us: u64) {}

    fn stop(&mut self) {}

    fn vented(&mut self) {}
}

/// Latencies for a host that wakes a little late, at every phase of the device's tick.
fn latencies_us(baud: u32, pause_us: Option<f64>) -> Vec<u64> {
    let mut settings = settings(CHANNELS);
    (settings.baud, settings.clock_drift_ppm) = (baud, 137.0);
    let mut port = Observed::new(&settings, (LinkFaults::NONE, 1), &[]).with_delays(1, 0.0);
    let options = StreamOptions::new(SESSION);
    let mut hand = Hand { pause_us, key_us: 0, pauses: Random::new(1, 8) };
    live(&mut port, &configuration(CHANNELS), &options, &mut hand, |_, _| {}).expect("it runs");
    port.counts.latencies_us
}

#[test]
fn set_point_sent_at_once_is_soon_accepted() {
    // A key's set point may have to wait for the one before it.
    let cases = [
        (115_200, None, 4.0),
        (1_000_000, None, 1.0),
        (115_200, Some(200_000.0), 8.0),
        (1_000_000, Some(200_000.0), 2.0),
    ];
    for (baud, pause_us, most_ms) in cases {
        let latencies_us = latencies_us(baud, pause_us);
        let (median_ms, p99_ms) = (percentile_ms(&latencies_us, 50), percentile_ms(&latencies_us, 99));
        println!(
            "{baud} Bd, keys {pause_us:?}: {} set points, p50 {median_ms:.2} ms, p99 {p99_ms:.2} ms",
            latencies_us.len()
        );
        assert!(latencies_us.len() > 2_000 && p99_ms <= most_ms, "{baud} Bd: {p99_ms} ms");
    }
}
