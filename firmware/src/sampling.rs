//! Samples beside the telemetry: at the rate that a host requests, several in one message.

use softlimb_protocol::{
    Batch, DeviceMessage, EncodeError, List, MAX_CHANNELS, PressureSample, ResultCode, Sample, SampleContent, Samples,
    SetSampling, Tick, TickFlags, Ticks, crc32c,
};

use crate::config::number;
use crate::controller::{Controller, TickInputs, TickOutputs};
use crate::dispatch::{Answer, OK, WRONG_STATE};
use crate::outbox::Outbox;
use crate::telemetry::tens_of_pascals;
use crate::valve::TICK_US;

/// Longest time between two samples, us: that of the telemetry.
const PERIOD_MAX_US: u32 = 10_000_000;

/// The samples of the message in progress.
#[derive(Clone, Debug)]
enum Pending {
    Measurements(Batch<Sample>),
    Ticks(Batch<Tick>),
}

impl Pending {
    const fn len(&self) -> usize {
        match self {
            Self::Measurements(samples) => samples.len(),
            Self::Ticks(ticks) => ticks.len(),
        }
    }

    fn clear(&mut self) {
        match self {
            Self::Measurements(samples) => samples.clear(),
            Self::Ticks(ticks) => ticks.clear(),
        }
    }
}

/// The sampling that a host has requested, and the samples of the message in progress.
#[derive(Clone, Debug)]
pub(crate) struct Sampling {
    /// Time between two samples, us; 0 if no host has requested samples.
    period_us: u32,
    per_message: u8,
    due_us: u64,
    first_us: u64,
    pending: Pending,
    left_out: u32,
}

impl Sampling {
    pub(crate) const fn new() -> Self {
        let pending = Pending::Measurements(Batch::new());
        Self { period_us: 0, per_message: 0, due_us: 0, first_us: 0, pending, left_out: 0 }
    }

    /// Stops sampling.
    pub(crate) fn stop(&mut self) {
        (self.period_us, self.left_out) = (0, 0);
        self.pending.clear();
    }

    /// Takes a new configuration: it ends measurements, but not ticks, which are needed from its first one on.
    pub(crate) fn reconfigure(&mut self, outbox: &mut Outbox) {
        match self.pending {
            Pending::Measurements(_) => self.stop(),
            Pending::Ticks(_) => self.send(outbox),
        }
    }

    fn is_due(&self, now_us: u64) -> bool {
        self.period_us > 0 && now_us >= self.due_us
    }

    /// Sends the message in progress where a sample at `now_us` does not follow the last one by a period.
    fn keep_together(&mut self, now_us: u64, outbox: &mut Outbox) {
        let (period_us, len) = (u64::from(self.period_us), self.pending.len());
        if now_us != self.first_us + period_us * len as u64 {
            self.send(outbox);
        }
        if self.pending.len() == 0 {
            self.first_us = now_us;
        }
        self.due_us = now_us.saturating_add(period_us);
    }

    /// Counts a sample that no message holds, and sends the message once it is full: of at most `most` samples.
    fn settle(&mut self, added: Result<(), EncodeError>, most: usize, outbox: &mut Outbox) {
        if added.is_err() {
            self.left_out = self.left_out.saturating_add(1);
        }
        if self.pending.len() >= usize::from(self.per_message).min(most) {
            self.send(outbox);
        }
    }

    fn send(&mut self, outbox: &mut Outbox) {
        if self.pending.len() == 0 {
            return;
        }
        let Self { first_us: time_us, period_us, left_out, .. } = *self;
        let message: DeviceMessage = match &self.pending {
            Pending::Measurements(samples) => Samples { time_us, period_us, left_out, samples: samples.clone() }.into(),
            Pending::Ticks(ticks) => Ticks { time_us, left_out, ticks: ticks.clone() }.into(),
        };
        if !(outbox.has_room_for_telemetry() && outbox.push(&message)) {
            self.left_out = left_out.saturating_add(self.pending.len() as u32);
        }
        self.pending.clear();
    }
}

impl<const N: usize> Controller<N> {
    /// Starts sampling with new settings, or stops it. Ticks can be requested before there is a configuration.
    pub(crate) fn set_sampling(&mut self, now_us: u64, request: &SetSampling) -> Answer {
        let Some(content) = request.content.known() else {
            return (ResultCode::UnknownCode, u32::from(number!(SetSampling, "content")));
        };
        let (pending, period_max_us, most) = match content {
            SampleContent::Measurements if self.config.is_none() => return WRONG_STATE,
            SampleContent::Measurements => {
                (Pending::Measurements(Batch::new()), PERIOD_MAX_US, Samples::most(self.channels.len()))
            }
            // The configuration to come decides how many a message holds: a message is sent once it is full.
            SampleContent::Ticks => (Pending::Ticks(Batch::new()), TICK_US, Ticks::most(1)),
        };
        let period_us = request.period_us;
        if period_us > period_max_us || !period_us.is_multiple_of(TICK_US) {
            return (ResultCode::OutOfRange, u32::from(number!(SetSampling, "period_us")));
        }
        if period_us > 0 && !(1..=most).contains(&usize::from(request.samples)) {
            return (ResultCode::OutOfRange, u32::from(number!(SetSampling, "samples")));
        }
        self.sampling.stop();
        self.sampling.pending = pending;
        self.sampling.period_us = period_us;
        self.sampling.per_message = request.samples;
        self.sampling.due_us = now_us;
        OK
    }

    /// Takes a sample if one is due.
    pub(crate) fn sample(&mut self, inputs: &TickInputs<N>, outputs: &TickOutputs<N>) {
        if self.config.is_none() || !self.sampling.is_due(inputs.now_us) {
            return;
        }
        let count = self.channels.len();
        let Self { sampling, outbox, channels, state, .. } = self;
        sampling.keep_together(inputs.now_us, outbox);
        let (added, most) = match &mut sampling.pending {
            Pending::Measurements(samples) => {
                let channels = channels.iter().map(|channel| PressureSample {
                    pressure_10pa: tens_of_pascals(channel.pressure_pa()),
                    duty: channel.duty().share(),
                });
                let Ok(channels) = List::try_from_iter(channels) else { return };
                (samples.push(&Sample { state: (*state).into(), channels }), Samples::most(count))
            }
            Pending::Ticks(ticks) => {
                let Ok(codes) = List::try_from_iter(inputs.pressure.iter().take(count).map(|code| code.0)) else {
                    return;
                };
                let tick = Tick {
                    flags: TickFlags::default().with(TickFlags::EMERGENCY_STOP, inputs.emergency_stop),
                    supply_code: inputs.supply.0,
                    valve_supply_code: inputs.valve_supply.0,
                    outputs_crc: checksum(outputs, count),
                    codes,
                };
                (ticks.push(&tick), Ticks::most(count))
            }
        };
        sampling.settle(added, most, outbox);
    }
}

/// CRC-32C of the outputs of a tick, as [`Tick::outputs_crc`] defines it.
fn checksum<const N: usize>(outputs: &TickOutputs<N>, channels: usize) -> u32 {
    let mut bytes = [0; 4 * MAX_CHANNELS + 3];
    let (places, _) = bytes.as_chunks_mut::<4>();
    for (place, valves) in places.iter_mut().zip(outputs.valves.iter().take(channels)) {
        let ([fill_0, fill_1], [vent_0, vent_1]) = (valves.fill_us.to_le_bytes(), valves.vent_us.to_le_bytes());
        *place = [fill_0, fill_1, vent_0, vent_1];
    }
    let end = 4 * channels;
    if let Some(rest) = bytes.get_mut(end..end + 3) {
        rest.copy_from_slice(&[u8::from(outputs.supply_open), outputs.pump_duty, outputs.digital.bits()]);
    }
    crc32c(bytes.get(..end + 3).unwrap_or_default())
}
