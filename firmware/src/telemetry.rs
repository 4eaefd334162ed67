//! What the device tells on its own: faults as they occur, measurements periodically.

use softlimb_protocol::{Fault, List, Telemetry};

use crate::channel::tens_of_pascals;
use crate::controller::Controller;

impl Controller {
    /// Queues untold faults and, when it is due, a telemetry message.
    pub(crate) fn report(&mut self, now_us: u64) {
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
            self.faults.told();
        }
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

    fn telemetry(&self, now_us: u64) -> Option<Telemetry> {
        let count = self.config.as_ref()?.channels.len();
        let samples = self.channels.iter().take(count).map(|channel| channel.sample(now_us));
        Some(Telemetry {
            time_us: now_us,
            state: self.state.into(),
            fault_bits: self.faults.bits(),
            supply_10pa: tens_of_pascals(self.supply.pressure_pa()),
            free_knots: self.queue.free(),
            next_index: self.queue.next_index(),
            ticks_late: self.ticks.late(),
            channels: List::try_from_iter(samples).ok()?,
        })
    }
}
