//! A host's look at a modelled serial line: when it handed over each set point, and when the device had it.

use std::collections::BTreeMap;
use std::io;

use softlimb_numerics::Random;
use softlimb_protocol::{Decoder, HostMessage};
use softlimb_rig::link::{DisturbedLink, Knot, LinkFaults, Transport};
use softlimb_sim::{SimSettings, SimulatedMcu};

/// Grain of the host's time, us: far below a tick.
const GRAIN_US: u64 = 50;

/// Set points on their way.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    /// From hand-over to acceptance of each set point, repetitions included, us.
    pub(crate) latencies_us: Vec<u64>,
    /// Set points that the device had only after their time.
    pub(crate) late: u64,
    /// Set points with other values in the device than in the trajectory.
    pub(crate) wrong: u64,
    /// Bits of times and values, 16 each, and bits on the line with start and stop bits, of all frames with set points.
    pub(crate) useful_bits: u64,
    pub(crate) line_bits: u64,
    /// All bytes.
    pub(crate) to_device: u64,
    pub(crate) to_host: u64,
}

/// The simulated device behind a line with faults, observed.
pub(crate) struct Observed<'a> {
    port: DisturbedLink<SimulatedMcu>,
    knots: &'a [Knot],
    /// Delays of a host that is not alone on its computer, and the share of those that are long.
    delays: Option<(Random, f64)>,
    decoder: Decoder<HostMessage>,
    frame_bytes: u64,
    start_us: u64,
    sent_us: BTreeMap<u32, u64>,
    next: u32,
    pub(crate) counts: Counts,
}

impl<'a> Observed<'a> {
    pub(crate) fn new(settings: &SimSettings, (faults, seed): (LinkFaults, u64), knots: &'a [Knot]) -> Self {
        let mcu = SimulatedMcu::new(settings).expect("good settings");
        Self {
            port: DisturbedLink::new(mcu, faults, seed),
            knots,
            delays: None,
            decoder: Decoder::new(),
            frame_bytes: 0,
            start_us: 0,
            sent_us: BTreeMap::new(),
            next: 0,
            counts: Counts::default(),
        }
    }

    /// A host that wakes late by 0.12 ms on average, and at a share of times by 20 ms more.
    pub(crate) fn with_delays(self, seed: u64, long: f64) -> Self {
        Self { delays: Some((Random::new(seed, 7), long)), ..self }
    }

    pub(crate) fn mcu(&self) -> &SimulatedMcu {
        self.port.port()
    }

    fn note_frame(&mut self, message: &HostMessage, bytes: u64, now_us: u64) {
        let (index, count, channels) = match message {
            HostMessage::Setpoint(setpoint) => (setpoint.index, 1, setpoint.values.len()),
            HostMessage::Knots(knots) => {
                let channels = knots.knots.iter().next().map_or(0, |step| step.steps.len());
                (knots.index, knots.knots.len() as u32, channels)
            }
            _ => return,
        };
        if let HostMessage::Setpoint(first) = message
            && index == 0
        {
            self.start_us = first.time_us;
        }
        self.counts.useful_bits += 16 * u64::from(count) * (1 + channels as u64);
        self.counts.line_bits += 10 * bytes;
        (index..index + count).for_each(|index| {
            self.sent_us.entry(index).or_insert(now_us);
        });
    }

    /// Looks for set points that the device has accepted since the last time.
    fn look(&mut self) {
        let next = self.mcu().controller().queue().next_index();
        if next < self.next {
            // Flushed: another beginning.
            self.sent_us.clear();
            self.next = 0;
        }
        for index in self.next..next {
            self.note_accepted(index);
        }
        self.next = next;
    }

    fn note_accepted(&mut self, index: u32) {
        let (now_us, device_us) = (self.now_us(), self.mcu().device_time_us());
        let sent_us = self.sent_us.get(&index).copied();
        self.counts.latencies_us.extend(sent_us.map(|sent_us| now_us - sent_us));
        // The last one is repeated at the end.
        let Some(knot) = self.knots.get(index as usize) else { return };
        let time_us = self.start_us + knot.time_us;
        self.counts.late += u64::from(device_us > time_us);
        let queue = self.port.port().controller().queue();
        let differs = |(channel, &value): (usize, &i32)| queue.value(channel, time_us) != Some(value as f32);
        self.counts.wrong += u64::from(knot.values.iter().enumerate().any(differs));
    }

    fn delay_us(&mut self) -> u64 {
        let Some((random, long)) = &mut self.delays else { return 0 };
        let mut exponential = |mean_us: f64| (-mean_us * (1.0 - random.uniform()).ln()) as u64;
        let (usual_us, spike_us) = (exponential(120.0), exponential(20_000.0));
        usual_us + if random.uniform() < *long { spike_us } else { 0 }
    }
}

impl Transport for Observed<'_> {
    fn now_us(&self) -> u64 {
        self.port.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.counts.to_device += bytes.len() as u64;
        for &byte in bytes {
            self.frame_bytes += 1;
            if let Some(Ok(frame)) = self.decoder.push(byte) {
                let (bytes, now_us) = (std::mem::take(&mut self.frame_bytes), self.port.now_us());
                self.note_frame(&frame.message, bytes, now_us);
            }
        }
        self.port.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        let before = into.len();
        self.port.receive(into)?;
        self.counts.to_host += (into.len() - before) as u64;
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        while self.now_us() < deadline_us && !self.mcu().is_readable() {
            let grain_us = deadline_us.min(self.now_us() + GRAIN_US);
            self.port.wait_until(grain_us);
            self.look();
            if self.now_us() < grain_us {
                break;
            }
        }
        let late_us = self.now_us() + self.delay_us();
        while self.now_us() < late_us {
            let grain_us = late_us.min(self.now_us() + GRAIN_US);
            self.port.port_mut().advance_to(grain_us);
            self.look();
        }
    }
}
