//! Error of the device's clock as the host estimates it.

use super::observed::Observed;
use crate::link_common::{SESSION, settings};
use softlimb_protocol::{Hello, PROTOCOL_VERSION, RetryPolicy, SCHEMA_HASH};
use softlimb_rig::link::{LinkFaults, Session, Transport};

const HELLO: Hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION };
/// The estimate counts from here on, us: 16 s fill it.
const FROM_US: u64 = 20_000_000;
const END_US: u64 = 60_000_000;

/// Errors of the estimate at every wake of the host, us, for a device whose clock has a start and a speed of its own.
fn errors_us(baud: u32, drift_ppm: f64, seed: u64) -> Vec<f64> {
    let mut settings = settings(1);
    (settings.baud, settings.clock_offset_us, settings.clock_drift_ppm) = (baud, 3_000_000_000 + 617 * seed, drift_ppm);
    let mut port = Observed::new(&settings, (LinkFaults::NONE, seed), &[]).with_delays(seed, 0.01);
    let mut session = Session::new(SESSION, RetryPolicy::default(), 25_000, 4);
    session.request(port.now_us(), &HELLO.into()).unwrap();
    let (mut errors, mut bytes) = (Vec::new(), Vec::new());
    while port.now_us() < END_US {
        bytes.clear();
        let due_us = session.transmit(port.now_us(), &mut bytes).unwrap();
        port.send(&bytes).unwrap();
        port.wait_until(due_us.min(port.now_us() + 10_000));
        bytes.clear();
        port.receive(&mut bytes).unwrap();
        let now_us = port.now_us();
        session.receive(now_us, &bytes).unwrap();
        let true_us = settings.clock_offset_us as f64 + now_us as f64 * (1.0 + drift_ppm * 1e-6);
        if now_us >= FROM_US
            && let Some(clock) = session.clock()
        {
            errors.push((clock.device_us(now_us) as f64 - true_us).abs());
        }
    }
    errors
}

#[test]
fn clock_of_the_device_is_known_to_a_tenth_of_a_millisecond() {
    for (baud, most_ms) in [(1_000_000, 0.1), (921_600, 0.1)] {
        let mut errors = Vec::new();
        for (seed, drift_ppm) in [(1, -100.0), (2, -30.0), (3, 0.0), (4, 30.0), (5, 100.0)] {
            errors.extend(errors_us(baud, drift_ppm, seed));
        }
        let of = |percent| softlimb_numerics::statistics::percentile(errors.iter().copied(), percent).unwrap() * 1e-3;
        println!(
            "{baud} Bd: {} looks, p50 {:.3} ms, p99 {:.3} ms, largest {:.3} ms",
            errors.len(),
            of(50),
            of(99),
            of(100)
        );
        assert!(errors.len() > 5_000 && of(99) <= most_ms, "{baud} Bd: p99 {} ms", of(99));
    }
}
