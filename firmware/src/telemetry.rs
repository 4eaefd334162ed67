//! Unsolicited messages of the device: faults and errors of the link as they occur, measurements periodically.

use softlimb_protocol::{Batch, ChannelSample, ChannelStatus, Fault, List, LogRecord, LogRecords, LogState, Telemetry};

use crate::channel::Channel;
use crate::controller::{Controller, TickInputs, TickOutputs};

/// Least interval between unsolicited LinkErrors, us. On a noisy line, they must leave room for other messages.
const LINK_ERRORS_US: u64 = 100_000;

impl<const N: usize> Controller<N> {
    /// Queues untold faults and, when they are due, samples and a telemetry message at the end of a tick.
    pub(crate) fn report(&mut self, inputs: &TickInputs<N>, outputs: &TickOutputs<N>) {
        let now_us = inputs.now_us;
        while let Some(&occurrence) = self.faults.untold() {
            let message = Fault {
                time_us: occurrence.time_us,
                channel: occurrence.channel,
                code: occurrence.code.into(),
                value: occurrence.value,
            };
            if !self.outbox.push(&message.into()) {
                break;
            }
            self.faults.mark_reported();
        }
        if self.link_errors_changed && now_us >= self.link_errors_due_us {
            self.send_link_errors(now_us);
        }
        self.sample(inputs, outputs);
        let Some(config) = &self.config else { return };
        if now_us < self.telemetry_due_us {
            return;
        }
        let period_us = u64::from(config.system.telemetry_period_us);
        // The schedule keeps its phase; after a gap it starts anew.
        self.telemetry_due_us = self.telemetry_due_us.saturating_add(period_us).max(now_us.saturating_add(1));
        if let Some(message) = self.telemetry(now_us)
            && self.outbox.has_room_for_telemetry()
        {
            self.outbox.push(&message.into());
        }
    }

    /// Queues LinkErrors if the outbox has room.
    pub(crate) fn send_link_errors(&mut self, now_us: u64) {
        if self.outbox.push(&self.link_errors.clone().into()) {
            self.link_errors_changed = false;
            self.link_errors_due_us = now_us.saturating_add(LINK_ERRORS_US);
        }
    }

    /// Queues a part of the log. The state comes last: it carries the number of records before it.
    pub(crate) fn send_log(&mut self, state: LogState, records: Batch<LogRecord>) {
        if records.is_empty() || self.outbox.push(&LogRecords { records }.into()) {
            self.outbox.push(&state.into());
        }
    }

    fn telemetry(&self, now_us: u64) -> Option<Telemetry> {
        let count = self.config.as_ref()?.channels.len();
        let samples = self.channels.iter().take(count).map(|channel| sample(channel, now_us));
        Some(Telemetry {
            time_us: now_us,
            state: self.state.into(),
            fault_bits: self.faults.bits(),
            supply_10pa: tens_of_pascals(self.supply.pressure_pa()),
            valve_supply_mv: self.valve_supply_mv,
            free_knots: self.queue.free(),
            next_index: self.queue.next_index(),
            ticks_late: self.ticks.late(),
            stack_used: self.stack_used,
            outputs: self.outputs,
            channels: List::try_from_iter(samples).ok()?,
        })
    }
}

/// One channel's part of the telemetry. The pressure is this tick's sample at the manifold, which reads high while filling and low
/// while venting; it is not the loop's estimate of the chamber.
fn sample(channel: &Channel, now_us: u64) -> ChannelSample {
    let inverse = channel.inverse().status();
    let pressure_pa = channel.pressure_pa();
    ChannelSample {
        pressure_10pa: tens_of_pascals(pressure_pa),
        reference_10pa: tens_of_pascals(channel.reference_pa(now_us).unwrap_or(pressure_pa)),
        duty: channel.duty().share(),
        status: ChannelStatus::default()
            .with(ChannelStatus::SENSOR_IMPLAUSIBLE, channel.sensor().is_implausible())
            .with(ChannelStatus::REFERENCE_LIMITED, inverse.limited)
            .with(ChannelStatus::INVERSE_FAILED, inverse.failed),
    }
}

/// A pressure as telemetry carries it; clipped at both ends.
pub(crate) fn tens_of_pascals(pressure_pa: f32) -> u16 {
    // The cast saturates and turns NaN into 0.
    (pressure_pa * 0.1 + 0.5) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressures_are_rounded_to_ten_pascals_and_clipped() {
        for (pressure_pa, wire) in [(0.0, 0), (14.9, 1), (15.1, 2), (-500.0, 0), (1e9, u16::MAX), (f32::NAN, 0)] {
            assert_eq!(tens_of_pascals(pressure_pa), wire, "{pressure_pa}");
        }
    }
}
