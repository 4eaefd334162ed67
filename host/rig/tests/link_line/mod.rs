//! The link over modelled serial lines, in virtual time: rates, latencies, faults, the device's clock.

mod clock;
mod latency;
mod observed;
mod rates;
mod table;

use crate::link_common::{SESSION, configuration, settings};
use observed::{Counts, Observed};
use softlimb_protocol::{DeviceState, Outputs, SampleContent, Samples};
use softlimb_rig::link::{Event, Knot, LinkError, LinkFaults, Sampling, StreamOptions, stream};

/// A line and what goes over it.
#[derive(Clone, Copy, Debug)]
struct Case {
    baud: u32,
    channels: usize,
    /// Time between two set points, us.
    knot_us: u64,
    /// Time between two samples, us.
    sample_us: u32,
    faults: LinkFaults,
    seed: u64,
    seconds: f64,
}

/// What came of it.
struct Outcome {
    counts: Counts,
    samples: Vec<Samples>,
    /// Whether the device ran out of set points.
    starved: bool,
    setpoints: u32,
    /// Set points sent again.
    repeated: u64,
    /// The shortest stretch of set points buffered while more were to come, us.
    buffered_min_us: Option<u64>,
    /// Duration of the session, s.
    session_s: f64,
}

impl Case {
    /// Pressures that differ from channel to channel, by steps that fit 16 bits.
    fn knots(&self) -> Vec<Knot> {
        let value = |time_us: u64, channel: usize| {
            let phase = (time_us / 20 + 2_000 * channel as u64) % 100_000;
            (phase.min(100_000 - phase) as i32 / 2).min((time_us / 20) as i32)
        };
        let count = (self.seconds * 1e6) as u64 / self.knot_us;
        let knot = |index| {
            let time_us = index * self.knot_us;
            let values = (0..self.channels).map(|channel| value(time_us, channel)).collect();
            Knot { time_us, outputs: Outputs::default(), values }
        };
        (0..=count).map(knot).collect()
    }

    fn run(&self) -> Result<Outcome, LinkError> {
        let knots = self.knots();
        let mut settings = settings(self.channels);
        settings.baud = self.baud;
        // The ticks of the device move past those of the host.
        settings.clock_drift_ppm = 137.0;
        let mut configuration = configuration(self.channels);
        configuration.system.telemetry_period_us = 100_000;
        let mut port = Observed::new(&settings, (self.faults, self.seed), &knots);
        let most = Samples::most(self.channels).min(8) as u8;
        let options = StreamOptions {
            sampling: Some(Sampling { period_us: self.sample_us, samples: most, content: SampleContent::Measurements }),
            // A buffer of 64 set points covers less at a high rate.
            buffer_us: StreamOptions::new(SESSION).buffer_us.min(62 * self.knot_us),
            ..StreamOptions::new(SESSION)
        };
        let (mut samples, mut states) = (Vec::new(), Vec::new());
        let summary = stream(&mut port, &configuration, &knots, &options, |_, event| match event {
            Event::Samples { message, .. } => samples.push(message),
            Event::State(state) => states.push(state),
            _ => {}
        })?;
        let session_s = port.mcu().now_us() as f64 * 1e-6;
        let starved = states.contains(&DeviceState::Holding);
        Ok(Outcome {
            counts: port.counts,
            samples,
            starved,
            setpoints: summary.setpoints,
            repeated: summary.statistics.setpoints_repeated,
            buffered_min_us: summary.buffered_min_us,
            session_s,
        })
    }
}

impl Outcome {
    /// Samples that arrived, and those missing between the first and the last of them.
    fn samples(&self) -> (u64, u64) {
        let times = self.samples.iter().flat_map(|message| {
            (0..message.samples.len() as u64).map(|index| message.time_us + index * u64::from(message.period_us))
        });
        let times: Vec<u64> = times.collect();
        let (Some(first), Some(last), Some(message)) = (times.first(), times.last(), self.samples.first()) else {
            return (0, 0);
        };
        let all = (last - first) / u64::from(message.period_us) + 1;
        (times.len() as u64, all - times.len() as u64)
    }

    /// The latency that a share of the set points does not exceed, ms.
    fn latency_ms(&self, percent: usize) -> f64 {
        percentile_ms(&self.counts.latencies_us, percent)
    }

    /// Share of the line's bits that times and values of set points are.
    fn efficiency(&self) -> f64 {
        self.counts.useful_bits as f64 / self.counts.line_bits as f64
    }

    /// Share of the time that the line to the device and the one to the host are busy.
    fn load(&self, baud: u32) -> [f64; 2] {
        [self.counts.to_device, self.counts.to_host]
            .map(|bytes| 10.0 * bytes as f64 / (f64::from(baud) * self.session_s))
    }
}

fn percentile_ms(values_us: &[u64], percent: usize) -> f64 {
    let value_us = softlimb_numerics::statistics::percentile(values_us.iter().copied(), percent);
    value_us.expect("set points were accepted") as f64 * 1e-3
}
