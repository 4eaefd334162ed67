//! Faults that a run meets on purpose: what breaks, and when.

use std::str::FromStr;

use softlimb_sim::plant::PartFault;

use crate::record::InjectedFault;

/// Length of a stall of the host, us.
const STALL_US: u64 = 600_000;

/// A fault with its time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedFault {
    /// Name, as on the command line.
    pub name: String,
    /// Time since the start of the run, us.
    pub time_us: u64,
    /// Channel, from 0; `None` for a fault of no channel.
    pub channel: Option<usize>,
    pub(super) kind: FaultKind,
}

/// Kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FaultKind {
    /// A part of the pneumatics.
    Part(PartFault),
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The device resets.
    Reset,
    /// The link stops carrying bytes, in both directions.
    LinkSilent,
    /// The host does nothing for a while.
    HostStall {
        /// Length, us.
        length_us: u64,
    },
}

const OTHERS: [(&str, FaultKind); 4] = [
    ("emergency-stop", FaultKind::EmergencyStop),
    ("device-reset", FaultKind::Reset),
    ("link-silent", FaultKind::LinkSilent),
    ("host-stall", FaultKind::HostStall { length_us: STALL_US }),
];

/// A word of the command line that is not a fault with a time.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TimedFaultError {
    /// No such fault.
    #[error("{name:?} is no fault; there are {}", known())]
    Unknown {
        /// The name as it was typed.
        name: String,
    },
    /// No time, or one that is not understood.
    #[error("the time of {name} is {time:?}; write seconds into the run from 0 on, as in {name}@2.5")]
    Time {
        /// Name of the fault.
        name: String,
        /// The time as it was typed.
        time: String,
    },
    /// Not a channel.
    #[error("the channel of {name} is {channel:?}; write a number from 0 on, as in {name}@2.5,1")]
    Channel {
        /// Name of the fault.
        name: String,
        /// The channel as it was typed.
        channel: String,
    },
    /// A channel for a fault that has none.
    #[error("{name} belongs to no channel; write {name}@2.5")]
    NoChannel {
        /// Name of the fault.
        name: String,
    },
    /// A fault of a channel without one.
    #[error("{name} needs a channel, from 0 on, as in {name}@2.5,1")]
    ChannelMissing {
        /// Name of the fault.
        name: String,
    },
}

impl TimedFault {
    /// All names, and whether a fault of each belongs to a channel.
    pub fn kinds() -> impl Iterator<Item = (&'static str, bool)> {
        let of_channel = |name| PartFault::named(name).is_some_and(|part| part.is_of_channel());
        Self::names().map(move |name| (name, of_channel(name)))
    }

    /// All names.
    pub fn names() -> impl Iterator<Item = &'static str> {
        PartFault::names().chain(OTHERS.into_iter().map(|(name, _)| name))
    }

    /// A fault without delay.
    ///
    /// # Errors
    /// As [`TimedFault::from_str`].
    pub(super) fn now(name: &str, channel: Option<usize>) -> Result<Self, TimedFaultError> {
        channel.map_or_else(|| format!("{name}@0"), |channel| format!("{name}@0,{channel}")).parse()
    }

    /// The same for the log.
    pub(super) fn injected(&self) -> InjectedFault {
        InjectedFault { name: self.name.clone(), time_s: self.time_us as f64 * 1e-6, channel: self.channel }
    }
}

fn known() -> String {
    TimedFault::names().collect::<Vec<_>>().join(", ")
}

fn kind(name: &str) -> Option<FaultKind> {
    let other = || OTHERS.into_iter().find_map(|(known, kind)| (known == name).then_some(kind));
    PartFault::named(name).map(FaultKind::Part).or_else(other)
}

impl FromStr for TimedFault {
    type Err = TimedFaultError;

    /// `NAME@TIME[,CHANNEL]`, the time in seconds.
    fn from_str(word: &str) -> Result<Self, TimedFaultError> {
        let (name, rest) = word.split_once('@').unwrap_or((word, ""));
        let name = name.trim().to_owned();
        let Some(kind) = kind(&name) else { return Err(TimedFaultError::Unknown { name }) };
        let (time, channel) = match rest.split_once(',') {
            Some((time, channel)) => (time, Some(channel.trim())),
            None => (rest, None),
        };
        let Some(time_us) = time_us(time) else {
            return Err(TimedFaultError::Time { name, time: time.to_owned() });
        };
        let has_channel = matches!(kind, FaultKind::Part(part) if part.is_of_channel());
        let channel = match (channel, has_channel) {
            (None, true) => return Err(TimedFaultError::ChannelMissing { name }),
            (Some(_), false) => return Err(TimedFaultError::NoChannel { name }),
            (None, false) => None,
            (Some(channel), true) => match channel.parse() {
                Ok(channel) => Some(channel),
                Err(_) => return Err(TimedFaultError::Channel { name, channel: channel.to_owned() }),
            },
        };
        Ok(Self { name, time_us, channel, kind })
    }
}

fn time_us(text: &str) -> Option<u64> {
    let text = text.trim();
    let seconds: f64 = text.strip_suffix('s').unwrap_or(text).trim().parse().ok()?;
    (0.0..=86_400.0).contains(&seconds).then_some((seconds * 1e6).round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_a_name_a_time_and_a_channel() {
        let fault: TimedFault = "sensor-frozen@2.5,1".parse().unwrap();
        assert_eq!((fault.name.as_str(), fault.time_us, fault.channel), ("sensor-frozen", 2_500_000, Some(1)));
        assert_eq!(fault.kind, FaultKind::Part(PartFault::SensorFrozen));
        let fault: TimedFault = "emergency-stop@0.25s".parse().unwrap();
        assert_eq!((fault.kind, fault.time_us, fault.channel), (FaultKind::EmergencyStop, 250_000, None));
    }

    #[test]
    fn wrong_words_are_named_with_what_is_allowed() {
        for (word, told) in [
            ("frozen@1,0", "\"frozen\" is no fault; there are fill-stuck-open, "),
            ("burst", "the time of burst is \"\""),
            ("burst@-1,0", "the time of burst is \"-1\""),
            ("burst@NaN,0", "the time of burst is \"NaN\""),
            ("burst@1,x", "the channel of burst is \"x\""),
            ("burst@1", "burst needs a channel"),
            ("pump-weak@1,0", "pump-weak belongs to no channel"),
        ] {
            let error = word.parse::<TimedFault>().unwrap_err().to_string();
            assert!(error.contains(told), "{word}: {error}");
        }
    }
}
