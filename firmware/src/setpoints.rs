//! Knots from the host: checked, then buffered.

use heapless::Vec;
use softlimb_protocol::{DeviceState, Knots, Outputs, ResultCode, Setpoint, StepInPlace};

use crate::config::number;
use crate::controller::Controller;
use crate::dispatch::{Answer, OK, WRONG_STATE};
use crate::manual::has_unknown;
use crate::queue::QueueError;

/// Farthest time of a knot from now, us: what lies beyond is the error of a clock or of a unit.
const HORIZON_US: u32 = 60_000_000;

/// Shortest time in which a setpoint may cross its limits, us: a valve fills a chamber of 30 mL to 100 kPa in that time.
const CROSSING_US: u32 = 100_000;

impl<const N: usize> Controller<N> {
    /// Buffers one knot.
    pub(crate) fn setpoint(&mut self, now_us: u64, setpoint: &Setpoint) -> Answer {
        let Setpoint { index, time_us, outputs, ref values, .. } = *setpoint;
        let values = self.checked(values.len(), values.iter().map(|&value| Some(value)));
        self.knot(now_us, index, (time_us, outputs, values), number!(Setpoint, "outputs"))
    }

    /// Buffers all knots of a message or none.
    pub(crate) fn knots(&mut self, now_us: u64, message: &Knots) -> Answer {
        if !self.takes_knots() {
            return WRONG_STATE;
        }
        // Before any step is taken: those of another knot than the last would lead elsewhere.
        let expected = self.queue.next_index();
        if message.index != expected {
            return (ResultCode::UnexpectedIndex, expected);
        }
        for (taken, step) in (0_u32..).zip(message.knots.in_place()) {
            let answer = self.step(now_us, message.index.wrapping_add(taken), step);
            if answer != OK {
                self.queue.take_back(taken);
                return answer;
            }
        }
        OK
    }

    fn step(&mut self, now_us: u64, index: u32, step: StepInPlace<'_>) -> Answer {
        let Some(before) = self.queue.last() else { return (ResultCode::NoKnotBefore, 0) };
        let time_us = before.time_us.saturating_add(u64::from(step.step_us));
        let steps = step.steps();
        // The knot before has a value for every channel.
        let stepped = |(step, &value): (i16, &i32)| value.checked_add(i32::from(step));
        let values = self.checked(steps.len(), steps.zip(&before.values).map(stepped));
        self.knot(now_us, index, (time_us, step.outputs, values), number!(Knots, "knots"))
    }

    fn takes_knots(&self) -> bool {
        self.config.is_some() && matches!(self.state, DeviceState::Ready | DeviceState::Running | DeviceState::Holding)
    }

    fn knot(
        &mut self,
        now_us: u64,
        index: u32,
        (time_us, outputs, values): (u64, Outputs, Result<Vec<i32, N>, Answer>),
        outputs_number: u8,
    ) -> Answer {
        let values = match values {
            Ok(values) => values,
            Err(answer) => return answer,
        };
        if has_unknown(outputs) {
            return (ResultCode::UnknownCode, outputs_number.into());
        }
        // The rate from another knot than the last means nothing.
        if index == self.queue.next_index() {
            if time_us > now_us.saturating_add(u64::from(HORIZON_US)) {
                return (ResultCode::BeyondHorizon, HORIZON_US);
            }
            if let Some(channel) = self.too_fast(time_us, &values) {
                return (ResultCode::TooFast, channel);
            }
        }
        match self.queue.push(now_us, index, time_us, (outputs, values)) {
            Ok(()) => OK,
            Err(QueueError::UnexpectedIndex { expected }) => (ResultCode::UnexpectedIndex, expected),
            Err(QueueError::Full) => (ResultCode::QueueFull, 0),
            Err(QueueError::Late) => (ResultCode::Late, 0),
        }
    }

    /// The first channel whose setpoint would cross its limits in less than [`CROSSING_US`]. A time that does not follow is late, not fast.
    fn too_fast(&self, time_us: u64, values: &[i32]) -> Option<u32> {
        let (config, before) = (self.config.as_ref()?, self.queue.last()?);
        let step_us = u32::try_from(time_us.checked_sub(before.time_us)?).ok()?;
        if !(1..CROSSING_US).contains(&step_us) {
            return None;
        }
        let mut changes = before.values.iter().zip(values).zip(&config.channels);
        let channel = changes.position(|((&from, &to), channel)| {
            let (low, high) = channel.setpoint_range;
            u64::from(from.abs_diff(to)) * u64::from(CROSSING_US) > u64::from(low.abs_diff(high)) * u64::from(step_us)
        });
        channel.map(|channel| channel as u32)
    }

    /// The values of a knot in the ranges of their channels; a `None` among them is in no range.
    fn checked(&self, count: usize, values: impl Iterator<Item = Option<i32>>) -> Result<Vec<i32, N>, Answer> {
        let Some(config) = self.config.as_ref().filter(|_| self.takes_knots()) else { return Err(WRONG_STATE) };
        let channels = config.channels.len();
        if count != channels {
            return Err((ResultCode::WrongChannelCount, channels as u32));
        }
        let mut checked = Vec::new();
        for (value, channel) in values.zip(&config.channels) {
            let (low, high) = channel.setpoint_range;
            let in_range = value.filter(|value| (low..=high).contains(value));
            // There is a place for every channel.
            let is_kept = in_range.is_some_and(|value| checked.push(value).is_ok());
            if !is_kept {
                return Err((ResultCode::OutOfRange, checked.len() as u32));
            }
        }
        Ok(checked)
    }
}
