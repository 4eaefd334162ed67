//! The controller run again on the inputs of a log, and its outputs compared with those of the log, bit for bit.
//!
//! The controller is a function of its ticks' times, its converter codes, its emergency stop, and the frames of the host with the look at the
//! link that took each: there are two in a tick. The log of a simulated or emulated device has the first three tick by tick
//! ([`Capture::ticks`]). A device behind a port sends them from its configuration on, where the host requests Ticks. The look that took a frame
//! is in the device's answer to it. Without the codes, what does not depend on them is compared. A device that
//! was configured before the log has a history that the log does not have: then the run alone is compared, without codes.

mod answers;
mod difference;
mod frames;
mod history;
mod inputs;
mod outputs;

use std::collections::BTreeMap;

use softlimb_protocol::{BootCause, CommandCode, DeviceMessage, HelloReply, HostMessage};
use softlimb_sim::{LOOK_US, Rerun};

use crate::record::{Capture, DeviceTick, Direction};
use difference::Compared;
pub use difference::Difference;
use frames::Framed;
use inputs::{Codes, Inputs};
use outputs::Coils;

/// Result of a re-run.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    /// Whether the log has the codes of the converters: all outputs were compared.
    pub is_exact: bool,
    /// Whether the device had a configuration before the log began: then only the run was compared, from its start on.
    pub has_history: bool,
    /// Ticks that were run again.
    pub ticks: u64,
    /// Ticks whose coil times, supply, pump and digital outputs were compared.
    pub ticks_compared: u64,
    /// Device time of the first tick that the log does not have although it has a later one, us: the comparison ends there.
    pub gap_us: Option<u64>,
    /// Messages of the device that were compared.
    pub messages: u64,
    /// Messages of the re-run that the log does not have: lost on the line, or left out by a device whose queue was full.
    pub messages_missing: u64,
    /// Frames of the host without an answer, which the re-run did not get.
    pub frames_unanswered: u64,
    /// Device time of the start of the run, us; `None` if none was told.
    pub start_us: Option<u64>,
    /// The first difference.
    pub difference: Option<Difference>,
}

/// Why a log cannot be run again.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReplayError {
    /// The log has no bytes of the link.
    #[error(
        "the log has no bytes of the link (topic /softlimb/wire): it is of an earlier build, or of `softlimb record` on a silent line"
    )]
    NoWire,
    /// The log does not say how the device started.
    #[error("the log holds no answer to a Hello: the re-run has no beginning")]
    NoHello,
    /// The device was configured before the log, and the log has no run to compare.
    #[error(
        "the device had a configuration before the log began, and the log has no run: reset the device before a log that is to be run again"
    )]
    NotFresh,
}

/// Runs the controller again on the inputs of a log.
///
/// # Errors
/// [`ReplayError`].
pub fn replay(capture: &Capture) -> Result<Replay, ReplayError> {
    if capture.wire.is_empty() {
        return Err(ReplayError::NoWire);
    }
    let told = frames::framed::<HostMessage>(capture, Direction::ToDevice);
    let heard = frames::framed::<DeviceMessage>(capture, Direction::ToHost);
    let hello = heard.iter().find_map(|frame| match &frame.message {
        DeviceMessage::HelloReply(reply) => Some(reply.clone()),
        _ => None,
    });
    let hello = hello.ok_or(ReplayError::NoHello)?;
    let (taken, frames_unanswered) = answers::ticks_of(&told, &heard);
    let start_us = told.iter().rev().find_map(|frame| match &frame.message {
        HostMessage::Command(command) if command.code == CommandCode::Start => Some(command.time_us),
        _ => None,
    });
    let has_history = hello.config_hash != 0;
    let from_us = if has_history { start_us.ok_or(ReplayError::NotFresh)? } else { 0 };
    let period_us = told.iter().rev().find_map(|frame| match &frame.message {
        HostMessage::ConfigSystem(system) => Some(u64::from(system.control_period_us)),
        _ => None,
    });
    let period_us = period_us.unwrap_or(1_000);
    let tracks_us = start_us.unwrap_or(u64::MAX).saturating_add(2 * period_us);
    let sent = inputs::sent(&heard);
    let first_us = sent.first().map(|tick| tick.device_us);
    let (codes, ticks) = if !capture.ticks.is_empty() {
        (Codes::Shown, &capture.ticks)
    } else if !has_history && first_us.is_some_and(|us| Some(us) == configured_us(&told, &taken).map(|us| us + 1_000)) {
        (Codes::Sent, &sent)
    } else {
        (Codes::Unknown, &sent)
    };
    let case = Case {
        capture,
        codes,
        ticks,
        told: &told,
        heard: &heard,
        hello: &hello,
        taken: &taken,
        from_us,
        tracks_us,
        period_us,
    };
    Ok(Replay { frames_unanswered, start_us, ..case.best() })
}

/// Device time of the tick that took the first configuration, us.
fn configured_us(told: &[Framed<HostMessage>], taken: &BTreeMap<u64, Vec<usize>>) -> Option<u64> {
    let is_commit = |index: &usize| matches!(told[*index].message, HostMessage::ConfigCommit(_));
    taken.iter().find(|(_, frames)| frames.iter().any(is_commit)).map(|(us, _)| *us)
}

/// A log taken apart.
struct Case<'a> {
    capture: &'a Capture,
    codes: Codes,
    /// The ticks that the log has, of a simulated or emulated device or sent by a device.
    ticks: &'a [DeviceTick],
    told: &'a [Framed<HostMessage>],
    heard: &'a [Framed<DeviceMessage>],
    hello: &'a HelloReply,
    /// Indices of the host's frames by the time of the device's look at the link, us.
    taken: &'a BTreeMap<u64, Vec<usize>>,
    /// Device time from which outputs are compared, us.
    from_us: u64,
    /// Device time from which all channels track setpoints, us.
    tracks_us: u64,
    /// Control period, us.
    period_us: u64,
}

impl Case<'_> {
    /// The re-run. Whether a device that does not show its ticks counts the first one as 0 or as 1 ms, only the comparison tells.
    fn best(&self) -> Replay {
        if let (Codes::Shown, Some(tick)) = (self.codes, self.ticks.first()) {
            return self.run(tick.device_us);
        }
        let [board, simulated] = [1_000, 0].map(|first_us| self.run(first_us));
        let is_board =
            board.difference.is_none() || (simulated.difference.is_some() && board.messages >= simulated.messages);
        if is_board { board } else { simulated }
    }

    fn run(&self, first_us: u64) -> Replay {
        let cause = self.hello.boot_cause.known().unwrap_or(BootCause::PowerOn);
        let mut controller = Rerun::new(cause, self.hello.boot_detail);
        let mut inputs = Inputs::new((self.codes, self.ticks), self.told, self.heard);
        let mut coils = Coils::new(self.capture.at_pins);
        let mut compared = Compared::new(self.heard, self.codes, (self.from_us, self.tracks_us));
        let (mut ticks, mut ticks_compared, mut gap_us, mut difference) = (0, 0, None, None);
        let last_us = self.last_us();
        let mut now_us = if self.codes == Codes::Shown { first_us } else { self.begin_us(first_us) };
        if self.has_history()
            && let Some(input) = inputs.at(now_us)
        {
            controller.turn(&input, &history::frames(self.told, self.hello.session));
            now_us += 1_000;
        }
        while now_us <= last_us && difference.is_none() && !compared.is_over() {
            let Some(input) = inputs.at(now_us) else {
                gap_us = Some(now_us);
                break;
            };
            if !self.codes.are_known() {
                // Measurements between messages are unknown: compared with the valves they would look frozen.
                controller.believe_readings();
            }
            let (outputs, mut sent) = controller.turn(&input, &self.received(now_us));
            sent.extend(controller.look(&input, &self.received(now_us + LOOK_US)));
            ticks += 1;
            let tick = inputs.shown();
            difference = tick.and_then(|tick| coils.compare(tick, &outputs));
            ticks_compared += u64::from(tick.is_some());
            difference = difference.or_else(|| compared.take(now_us, &sent));
            now_us += 1_000;
        }
        Replay {
            is_exact: self.codes.are_known(),
            has_history: self.has_history(),
            ticks,
            ticks_compared: ticks_compared + compared.ticks,
            gap_us,
            messages: compared.matched,
            messages_missing: compared.missing,
            frames_unanswered: 0,
            start_us: None,
            difference,
        }
    }

    fn has_history(&self) -> bool {
        self.hello.config_hash != 0
    }

    /// Device time at which the re-run begins, us: some seconds before the log, by whole control periods after the first tick. Without a
    /// configuration a controller stays as it is, however long.
    fn begin_us(&self, first_us: u64) -> u64 {
        let before_us = self.hello.mcu_time_us.saturating_sub(history::BEFORE_US).saturating_sub(first_us);
        first_us + before_us / self.period_us * self.period_us
    }

    /// The host's frames that the device took at a time of its clock, us.
    fn received(&self, device_us: u64) -> Vec<u8> {
        let frames = self.taken.get(&device_us).into_iter().flatten();
        frames.flat_map(|&index| self.told[index].bytes.iter().copied()).collect()
    }

    /// The last tick that the log knows of, us.
    fn last_us(&self) -> u64 {
        let known = self.ticks.last().filter(|_| self.codes.are_known()).map(|tick| tick.device_us);
        known.or_else(|| self.heard.iter().rev().find_map(|frame| answers::device_us(&frame.message))).unwrap_or(0)
    }
}
