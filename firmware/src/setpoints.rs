//! Knots from the host: checked, then buffered.

use heapless::Vec;
use softlimb_protocol::{DeviceState, KnotStep, Knots, Outputs, ResultCode, Setpoint};

use crate::config::number;
use crate::controller::Controller;
use crate::dispatch::{Answer, OK, WRONG_STATE};
use crate::manual::has_unknown;
use crate::queue::QueueError;

impl<const N: usize> Controller<N> {
    /// Buffers one knot.
    pub(crate) fn setpoint(&mut self, now_us: u64, setpoint: &Setpoint) -> Answer {
        let Setpoint { index, time_us, outputs, ref values, .. } = *setpoint;
        let Ok(values) = Vec::from_slice(values) else { return self.wrong_count() };
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
        for (taken, step) in (0_u32..).zip(message.knots.iter()) {
            let answer = self.step(now_us, message.index.wrapping_add(taken), &step);
            if answer != OK {
                self.queue.take_back(taken);
                return answer;
            }
        }
        OK
    }

    fn step(&mut self, now_us: u64, index: u32, step: &KnotStep) -> Answer {
        let Some(before) = self.queue.last() else { return (ResultCode::NoKnotBefore, 0) };
        let time_us = before.time_us.saturating_add(u64::from(step.step_us));
        match stepped(&before.values, &step.steps) {
            Ok(values) => self.knot(now_us, index, (time_us, step.outputs, values), number!(Knots, "knots")),
            Err(answer) => answer,
        }
    }

    fn takes_knots(&self) -> bool {
        self.config.is_some() && matches!(self.state, DeviceState::Ready | DeviceState::Running | DeviceState::Holding)
    }

    fn knot(
        &mut self,
        now_us: u64,
        index: u32,
        (time_us, outputs, values): (u64, Outputs, Vec<i32, N>),
        outputs_number: u8,
    ) -> Answer {
        let Some(config) = self.config.as_ref().filter(|_| self.takes_knots()) else { return WRONG_STATE };
        if values.len() != config.channels.len() {
            return self.wrong_count();
        }
        let outside = values.iter().zip(&config.channels).position(|(value, channel)| {
            let (low, high) = channel.setpoint_range;
            !(low..=high).contains(value)
        });
        if let Some(channel) = outside {
            return (ResultCode::OutOfRange, channel as u32);
        }
        if has_unknown(outputs) {
            return (ResultCode::UnknownCode, outputs_number.into());
        }
        match self.queue.push(now_us, index, time_us, (outputs, values)) {
            Ok(()) => OK,
            Err(QueueError::UnexpectedIndex { expected }) => (ResultCode::UnexpectedIndex, expected),
            Err(QueueError::Full) => (ResultCode::QueueFull, 0),
            Err(QueueError::Late) => (ResultCode::Late, 0),
        }
    }

    /// The answer to a knot with another number of values than channels.
    fn wrong_count(&self) -> Answer {
        if self.takes_knots() { (ResultCode::WrongChannelCount, self.channels.len() as u32) } else { WRONG_STATE }
    }
}

/// The values one step further.
fn stepped<const N: usize>(before: &Vec<i32, N>, steps: &[i16]) -> Result<Vec<i32, N>, Answer> {
    if before.len() != steps.len() {
        return Err((ResultCode::WrongChannelCount, before.len() as u32));
    }
    let mut values = before.clone();
    for (channel, (value, &step)) in (0_u32..).zip(values.iter_mut().zip(steps)) {
        *value = value.checked_add(i32::from(step)).ok_or((ResultCode::OutOfRange, channel))?;
    }
    Ok(values)
}
