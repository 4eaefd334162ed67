//! Setpoints on their way: a window that goes back to the index the device expects.
//!
//! Several knots share a frame, each as the step from the one before it. The first knot, and one too far from the one before, is sent whole and
//! alone.
//!
//! The device accepts only the next index, so every answer is cumulative. It also names its free places: `next index + free places` never
//! falls while the buffer is not flushed, and no knot at or beyond it is sent, so the buffer never overflows.

use std::collections::VecDeque;

use softlimb_protocol::{Ack, Batch, HostMessage, Knots, ResultCode, Setpoint};

use super::error::LinkError;
use super::trajectory::{Checked, Knot, Trajectory};

/// Knots sent and not yet answered, at most: keeps the line busy at 115200 baud without filling the device's buffers.
const IN_FLIGHT_MAX: u32 = 16;

/// Frames in a row that arrive before frames get longer again.
const ARRIVALS: u32 = 8;

/// The knots that each transmission carried.
#[derive(Clone, Copy, Debug)]
struct Transmission {
    seq: u16,
    index: u32,
    count: u32,
}

/// The sending side of the setpoint buffer.
#[derive(Clone, Debug)]
pub(super) struct Window {
    trajectory: Trajectory,
    start_us: u64,
    is_open: bool,
    /// Knots in a frame, at most.
    batch: u32,
    /// Knots in a frame now, if that many are pending: half after a loss, since a bad line damages long frames more often, and double after a row of
    /// frames that arrived.
    size: u32,
    /// Frames that arrived since the last change of the size.
    arrived: u32,
    /// The knot to send next.
    next: u32,
    /// One behind the highest knot ever sent.
    sent_end: u32,
    /// Knots before this one are in the device.
    accepted: u32,
    /// Device time of the latest answer that says so, us.
    accepted_at_us: u64,
    /// Knots from this one on have no place yet.
    credit_end: u64,
    in_flight: VecDeque<Transmission>,
    timeout_us: u64,
    progress_us: u64,
    repeated: u64,
}

impl Window {
    /// A closed window of frames with up to `batch` knots; without an answer for `timeout_us` it sends again.
    pub(super) fn new(timeout_us: u64, batch: u8) -> Self {
        let batch = u32::from(batch).clamp(1, IN_FLIGHT_MAX);
        Self {
            trajectory: Trajectory::default(),
            start_us: 0,
            is_open: false,
            batch,
            size: batch,
            arrived: 0,
            next: 0,
            sent_end: 0,
            accepted: 0,
            accepted_at_us: 0,
            credit_end: 0,
            in_flight: VecDeque::new(),
            timeout_us,
            progress_us: 0,
            repeated: 0,
        }
    }

    /// Sets what is sent when the window opens.
    pub(super) fn load(&mut self, trajectory: Trajectory) {
        self.close();
        self.trajectory = trajectory;
    }

    /// Begins with knot 0 for an empty buffer of `free` places; knots count from device time `start_us`.
    pub(super) fn open(&mut self, now_us: u64, start_us: u64, free: u16) {
        let trajectory = std::mem::take(&mut self.trajectory);
        let credit_end = u64::from(free);
        // No more than fit into a frame and into the buffer.
        let most = Knots::most(trajectory.channels()) as u32;
        let batch = self.batch.min(most).min(u32::from(free)).max(1);
        let size = self.size.min(batch);
        let kept = Self { trajectory, repeated: self.repeated, batch, size, ..Self::new(self.timeout_us, 1) };
        *self = Self { start_us, is_open: true, credit_end, progress_us: now_us, ..kept };
    }

    /// Adds a knot behind the last one.
    ///
    /// # Errors
    /// That of [`Trajectory::push`].
    pub(super) fn push(&mut self, knot: &Knot) -> Result<(), LinkError> {
        self.trajectory.push(knot)
    }

    /// The last knot that is in the device.
    pub(super) fn last_accepted(&self) -> Option<&Checked> {
        self.trajectory.knot(self.accepted.checked_sub(1)?)
    }

    /// Sends nothing more.
    pub(super) fn close(&mut self) {
        self.is_open = false;
    }

    /// The next knots to send now with frame number `seq`, if there are enough for a frame.
    pub(super) fn send(&mut self, now_us: u64, session: u16, seq: u16) -> Option<HostMessage> {
        if !self.is_open {
            return None;
        }
        if self.is_waiting() && now_us >= self.due_us() {
            self.go_back(now_us, self.accepted);
        }
        let index = self.next;
        let wanted = self.size.min(self.trajectory.len().saturating_sub(index));
        let places = self.credit_end.saturating_sub(u64::from(index)).min(u64::from(IN_FLIGHT_MAX));
        let allowed = (places as u32).min(IN_FLIGHT_MAX.saturating_sub(index - self.accepted));
        if wanted == 0 || allowed < wanted {
            return None;
        }
        let (message, count) = self.frame(session, index, wanted)?;
        if !self.is_waiting() {
            self.progress_us = now_us;
        }
        self.repeated += u64::from(self.sent_end.min(index + count).saturating_sub(index));
        self.next += count;
        self.sent_end = self.sent_end.max(self.next);
        self.in_flight.push_back(Transmission { seq, index, count });
        Some(message)
    }

    /// Up to `wanted` knots from `index` on, and their number.
    fn frame(&self, session: u16, index: u32, wanted: u32) -> Option<(HostMessage, u32)> {
        let mut knots = Batch::new();
        let steps = (index..index + wanted).map_while(|index| self.trajectory.step(index));
        steps.take_while(|step| knots.push(step).is_ok()).count();
        if !knots.is_empty() {
            let count = knots.len() as u32;
            return Some((Knots { session, index, knots }.into(), count));
        }
        let Checked { time_us, outputs, values } = self.trajectory.knot(index)?.clone();
        let time_us = self.start_us.saturating_add(time_us);
        Some((Setpoint { session, index, time_us, outputs, values }.into(), 1))
    }

    /// When to send again without an answer, us; never if nothing is in flight.
    pub(super) fn due_us(&self) -> u64 {
        if self.is_open && self.is_waiting() { self.progress_us.saturating_add(self.timeout_us) } else { u64::MAX }
    }

    /// Takes the answer to a setpoint. Answers to transmissions given up are ignored.
    ///
    /// # Errors
    /// When the device refuses a knot for good.
    pub(super) fn on_ack(&mut self, now_us: u64, ack: &Ack) -> Result<(), LinkError> {
        let position = self.in_flight.iter().position(|sent| sent.seq == ack.ref_seq);
        let Some(position) = position.filter(|_| self.is_open) else { return Ok(()) };
        let Transmission { index, count, .. } = self.in_flight[position];
        // Earlier transmissions were lost, or their answers, or these come too late to matter.
        self.in_flight.drain(..=position);
        match ack.result.known() {
            Some(ResultCode::Ok) => {
                self.accept(now_us, index + count, ack.free_knots);
                self.accepted_at_us = self.accepted_at_us.max(ack.mcu_time_us);
                self.grow();
            }
            // A device goes back to no index but the first; any other from before is an answer that a later one overtook. So is the first
            // where it was said no later than an acceptance.
            Some(ResultCode::UnexpectedIndex)
                if ack.detail == 0 && self.accepted > 0 && ack.mcu_time_us > self.accepted_at_us =>
            {
                return Err(LinkError::SetpointsDropped);
            }
            Some(ResultCode::UnexpectedIndex) => {
                self.accept(now_us, ack.detail, ack.free_knots);
                if ack.detail < index && self.accepted <= index {
                    self.go_back(now_us, self.accepted);
                }
            }
            Some(ResultCode::QueueFull) => {
                self.credit_end = u64::from(self.accepted);
                self.go_back(now_us, self.accepted);
            }
            Some(ResultCode::WrongSession) => return Err(LinkError::DeviceRestarted),
            // A device that stopped accepts no knots; its state says why it stopped.
            Some(ResultCode::WrongState) => self.close(),
            _ => return Err(LinkError::KnotRefused { index, result: ack.result, detail: ack.detail }),
        }
        Ok(())
    }

    /// Takes the cumulative answer that Telemetry of a device time carries.
    pub(super) fn on_progress(&mut self, now_us: u64, device_us: u64, next_index: u32, free: u16) {
        if self.is_open {
            if (1..=self.sent_end).contains(&next_index) {
                self.accepted_at_us = self.accepted_at_us.max(device_us);
            }
            self.accept(now_us, next_index, free);
        }
    }

    /// Takes free places without an index, as HeartbeatReply has them: the device has at least the knots whose answers came before.
    pub(super) fn on_places(&mut self, free: u16) {
        if self.is_open {
            self.credit_end = self.credit_end.max(u64::from(self.accepted) + u64::from(free));
        }
    }

    /// Knots in the device or passed by it.
    pub(super) fn accepted(&self) -> u32 {
        self.accepted
    }

    /// Whether the device has all knots, or has no places for another frame.
    pub(super) fn is_filled(&self) -> bool {
        let next_end = u64::from(self.accepted) + u64::from(self.size);
        self.is_open && (self.is_complete() || next_end > self.credit_end)
    }

    /// Whether all knots are in the device.
    pub(super) fn is_complete(&self) -> bool {
        self.accepted >= self.trajectory.len()
    }

    /// Knots in all.
    pub(super) fn total(&self) -> u32 {
        self.trajectory.len()
    }

    /// Device time of the last accepted knot, us.
    pub(super) fn accepted_until_us(&self) -> Option<u64> {
        let knot = self.trajectory.knot(self.accepted.checked_sub(1)?)?;
        Some(self.start_us.saturating_add(knot.time_us))
    }

    /// Setpoints sent again.
    pub(super) fn repeated(&self) -> u64 {
        self.repeated
    }

    fn is_waiting(&self) -> bool {
        self.accepted < self.next
    }

    fn accept(&mut self, now_us: u64, next_index: u32, free: u16) {
        if next_index > self.sent_end {
            return;
        }
        if next_index > self.accepted {
            self.accepted = next_index;
            self.progress_us = now_us;
        }
        self.next = self.next.max(self.accepted);
        self.credit_end = self.credit_end.max(u64::from(next_index) + u64::from(free));
    }

    fn grow(&mut self) {
        self.arrived += 1;
        if self.arrived >= ARRIVALS {
            (self.size, self.arrived) = ((2 * self.size).min(self.batch), 0);
        }
    }

    fn go_back(&mut self, now_us: u64, index: u32) {
        (self.size, self.arrived) = ((self.size / 2).max(1), 0);
        self.next = index;
        self.in_flight.clear();
        self.progress_us = now_us;
    }
}

#[cfg(test)]
mod tests;
