//! Samples beside the telemetry: at the rate that a host requests, several in one message.

use softlimb_protocol::{Batch, List, PressureSample, ResultCode, Sample, Samples, SetSampling};

use crate::config::number;
use crate::controller::Controller;
use crate::dispatch::{Answer, OK, WRONG_STATE};
use crate::outbox::Outbox;
use crate::telemetry::tens_of_pascals;
use crate::valve::TICK_US;

/// Longest time between two samples, us: that of the telemetry.
const PERIOD_MAX_US: u32 = 10_000_000;

/// The sampling that a host has requested, and the samples of the message in progress.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    /// Time between two samples, us; 0 if no host has requested samples.
    period_us: u32,
    per_message: u8,
    due_us: u64,
    first_us: u64,
    batch: Batch<Sample>,
    left_out: u32,
}

impl Sampling {
    pub(crate) const fn new() -> Self {
        Self { period_us: 0, per_message: 0, due_us: 0, first_us: 0, batch: Batch::new(), left_out: 0 }
    }

    /// Stops sampling.
    pub(crate) fn stop(&mut self) {
        (self.period_us, self.left_out) = (0, 0);
        self.batch.clear();
    }

    fn is_due(&self, now_us: u64) -> bool {
        self.period_us > 0 && now_us >= self.due_us
    }

    /// Takes a sample, and sends the message once it is full. A sample after a gap in time begins a new message.
    fn add(&mut self, now_us: u64, sample: &Sample, outbox: &mut Outbox) {
        let period_us = u64::from(self.period_us);
        if now_us != self.first_us + period_us * self.batch.len() as u64 {
            self.send(outbox);
        }
        if self.batch.is_empty() {
            self.first_us = now_us;
        }
        if self.batch.push(sample).is_err() {
            self.left_out = self.left_out.saturating_add(1);
        }
        self.due_us = now_us.saturating_add(period_us);
        if self.batch.len() >= usize::from(self.per_message) {
            self.send(outbox);
        }
    }

    fn send(&mut self, outbox: &mut Outbox) {
        if self.batch.is_empty() {
            return;
        }
        let Self { first_us, period_us, left_out, ref batch, .. } = *self;
        let message = Samples { time_us: first_us, period_us, left_out, samples: batch.clone() };
        if !(outbox.has_room_for_telemetry() && outbox.push(&message.into())) {
            self.left_out = left_out.saturating_add(self.batch.len() as u32);
        }
        self.batch.clear();
    }
}

impl<const N: usize> Controller<N> {
    /// Starts sampling with new settings, or stops it.
    pub(crate) fn set_sampling(&mut self, now_us: u64, request: &SetSampling) -> Answer {
        if self.config.is_none() {
            return WRONG_STATE;
        }
        let period_us = request.period_us;
        if period_us > PERIOD_MAX_US || !period_us.is_multiple_of(TICK_US) {
            return (ResultCode::OutOfRange, u32::from(number!(SetSampling, "period_us")));
        }
        let most = Samples::most(self.channels.len());
        if period_us > 0 && !(1..=most).contains(&usize::from(request.samples)) {
            return (ResultCode::OutOfRange, u32::from(number!(SetSampling, "samples")));
        }
        self.sampling.stop();
        self.sampling.period_us = period_us;
        self.sampling.per_message = request.samples;
        self.sampling.due_us = now_us;
        OK
    }

    /// Takes a sample if one is due.
    pub(crate) fn sample(&mut self, now_us: u64) {
        if !self.sampling.is_due(now_us) {
            return;
        }
        let channels = self.channels.iter().map(|channel| PressureSample {
            pressure_10pa: tens_of_pascals(channel.pressure_pa()),
            duty: channel.duty().share(),
        });
        let Ok(channels) = List::try_from_iter(channels) else { return };
        let sample = Sample { state: self.state.into(), channels };
        self.sampling.add(now_us, &sample, &mut self.outbox);
    }
}
