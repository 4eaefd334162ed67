//! Compares the device's messages with those of the log.

use softlimb_protocol::{ChannelSample, ChannelStatus, DeviceMessage, DeviceState, Telemetry, Ticks};

use super::answers::device_us;
use super::frames::{Framed, Splitter};
use super::inputs::Codes;

/// The first output that differs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// Device time of the tick, us.
    pub device_us: u64,
    /// The channel or the part of a message, in words.
    pub at: String,
    /// Value in the log.
    pub expected: String,
    /// Value of the re-run.
    pub got: String,
}

/// Compares message after message.
pub(super) struct Compared<'a> {
    heard: &'a [Framed<DeviceMessage>],
    codes: Codes,
    /// Device times from which messages are compared, and from which all channels track setpoints, us.
    from_us: u64,
    tracks_us: u64,
    next: usize,
    splitter: Splitter,
    pub(super) matched: u64,
    /// Ticks whose outputs a checksum of the device confirmed.
    pub(super) ticks: u64,
    pub(super) missing: u64,
    has_run: bool,
    is_over: bool,
}

impl<'a> Compared<'a> {
    pub(super) fn new(heard: &'a [Framed<DeviceMessage>], codes: Codes, (from_us, tracks_us): (u64, u64)) -> Self {
        let splitter = Splitter::default();
        Self {
            heard,
            codes,
            from_us,
            tracks_us,
            next: 0,
            splitter,
            matched: 0,
            ticks: 0,
            missing: 0,
            has_run: false,
            is_over: false,
        }
    }

    /// Whether nothing is left that can be compared without the codes: the run has ended, and how long pressures take to go down depends on them.
    pub(super) fn is_over(&self) -> bool {
        self.is_over
    }

    /// Takes the bytes that the re-run sends in a tick.
    pub(super) fn take(&mut self, now_us: u64, sent: &[u8]) -> Option<Difference> {
        let mut messages = Vec::new();
        self.splitter.take(sent, |_, message: DeviceMessage, _| messages.push(message));
        messages.into_iter().find_map(|got| self.compare(now_us, &got))
    }

    fn compare(&mut self, now_us: u64, got: &DeviceMessage) -> Option<Difference> {
        let got = self.comparable(got)?;
        while self.heard.get(self.next).is_some_and(|frame| self.comparable(&frame.message).is_none()) {
            self.next += 1;
        }
        let expected = self.comparable(&self.heard.get(self.next)?.message)?;
        self.is_over |=
            !self.codes.are_known() && self.has_run && state(&expected).is_some_and(|it| it != DeviceState::Running);
        if self.is_over {
            return None;
        }
        self.has_run |= state(&expected) == Some(DeviceState::Running);
        if expected == got {
            self.next += 1;
            self.matched += 1;
            if let DeviceMessage::Ticks(ticks) = &got {
                self.ticks += ticks.ticks.len() as u64;
            }
            return None;
        }
        // A later message of the log that is the same: those between are missing in the re-run, which is a difference. A message of the re-run
        // that is older than the log's next one is missing in the log.
        let is_older = matches!((device_us(&got), device_us(&expected)), (Some(got), Some(expected)) if got < expected);
        if is_older {
            self.missing += 1;
            return None;
        }
        let in_ticks = match (&expected, &got) {
            (DeviceMessage::Ticks(expected), DeviceMessage::Ticks(got)) => first_of_ticks(expected, got),
            _ => None,
        };
        in_ticks.or_else(|| {
            let (at, expected, got) = first_field(&expected, &got);
            Some(Difference { device_us: now_us, at, expected, got })
        })
    }

    /// A message without what is measured and not decided: the stack in use, the number of channels of the board, and without the codes of
    /// the converters all that depends on them. `None` where nothing is left.
    fn comparable(&self, message: &DeviceMessage) -> Option<DeviceMessage> {
        if device_us(message).is_some_and(|us| us < self.from_us) {
            return None;
        }
        let mut message = message.clone();
        match &mut message {
            // Of a port and of a memory that the re-run does not have.
            DeviceMessage::LinkErrors(_) | DeviceMessage::LogRecords(_) | DeviceMessage::LogState(_) => return None,
            DeviceMessage::HelloReply(reply) => reply.channels_max = 0,
            DeviceMessage::Telemetry(telemetry) => {
                telemetry.stack_used = 0;
                if self.codes == Codes::Sent {
                    // Of the time before the log too.
                    telemetry.ticks_late = 0;
                }
                if !self.codes.are_known() {
                    decided(telemetry, self.tracks_us);
                }
            }
            DeviceMessage::Ack(_) | DeviceMessage::HeartbeatReply(_) => {}
            _ if !self.codes.are_known() => return None,
            // How full the transmitter was depends on the line.
            DeviceMessage::Samples(samples) => samples.left_out = 0,
            DeviceMessage::Ticks(ticks) => ticks.left_out = 0,
            DeviceMessage::Fault(_) => {}
        }
        Some(message)
    }
}

fn state(message: &DeviceMessage) -> Option<DeviceState> {
    match message {
        DeviceMessage::Telemetry(telemetry) => telemetry.state.known(),
        _ => None,
    }
}

/// Leaves what follows from the host's frames alone: state, buffer, outputs, and while the device runs the references. Before a channel's first
/// control period its reference is the measured pressure.
fn decided(telemetry: &mut Telemetry, tracks_us: u64) {
    let is_running = telemetry.state == DeviceState::Running && telemetry.time_us >= tracks_us;
    (telemetry.supply_10pa, telemetry.valve_supply_mv) = (0, 0);
    (telemetry.fault_bits, telemetry.ticks_late) = (0, 0);
    for channel in telemetry.channels.iter_mut() {
        let ChannelSample { reference_10pa, status, .. } = *channel;
        let implausible = ChannelStatus::SENSOR_IMPLAUSIBLE;
        *channel = ChannelSample {
            pressure_10pa: 0,
            reference_10pa: if is_running { reference_10pa } else { 0 },
            duty: 0,
            status: status.with(implausible, false),
        };
    }
}

/// Name and values of the first field that differs.
fn first_field(expected: &DeviceMessage, got: &DeviceMessage) -> (String, String, String) {
    if let (DeviceMessage::Telemetry(expected), DeviceMessage::Telemetry(got)) = (expected, got)
        && expected.time_us == got.time_us
    {
        return first_of_telemetry(expected, got);
    }
    ("message".to_owned(), format!("{expected:?}"), format!("{got:?}"))
}

/// The first tick of other outputs; `None` where the messages begin at different times or the outputs are equal.
fn first_of_ticks(expected: &Ticks, got: &Ticks) -> Option<Difference> {
    let first_us = expected.time_us;
    let mut pairs = (0_u64..).zip(expected.ticks.iter().zip(got.ticks.iter()));
    let differing = pairs.find(|(_, (expected, got))| expected.outputs_crc != got.outputs_crc);
    let (index, (expected, got)) = differing.filter(|_| first_us == got.time_us)?;
    let crc = |crc: u32| format!("checksum {crc:08x}");
    Some(Difference {
        device_us: first_us + 1_000 * index,
        at: "coils, supply valve, pump and digital outputs".to_owned(),
        expected: crc(expected.outputs_crc),
        got: crc(got.outputs_crc),
    })
}

fn first_of_telemetry(expected: &Telemetry, got: &Telemetry) -> (String, String, String) {
    for (channel, (expected, got)) in expected.channels.iter().zip(got.channels.iter()).enumerate() {
        let fields = [
            ("pressure, 10 Pa", i32::from(expected.pressure_10pa), i32::from(got.pressure_10pa)),
            ("reference, 10 Pa", i32::from(expected.reference_10pa), i32::from(got.reference_10pa)),
            ("duty, 1/127", i32::from(expected.duty), i32::from(got.duty)),
            ("status", i32::from(expected.status.bits()), i32::from(got.status.bits())),
        ];
        if let Some((name, expected, got)) = fields.into_iter().find(|(_, expected, got)| expected != got) {
            return (format!("channel {channel}, {name}"), expected.to_string(), got.to_string());
        }
    }
    let fields = |of: &Telemetry| {
        let bits = (of.fault_bits, of.outputs.bits());
        [
            ("state", format!("{:?}", of.state)),
            ("faults", format!("{:016b}", bits.0)),
            ("supply, 10 Pa", of.supply_10pa.to_string()),
            ("valves' supply, mV", of.valve_supply_mv.to_string()),
            ("free places for knots", of.free_knots.to_string()),
            ("next knot", of.next_index.to_string()),
            ("late ticks", of.ticks_late.to_string()),
            ("digital outputs", format!("{:08b}", bits.1)),
        ]
    };
    let differs = fields(expected).into_iter().zip(fields(got)).find(|((_, expected), (_, got))| expected != got);
    differs.map_or_else(
        || ("telemetry".to_owned(), format!("{expected:?}"), format!("{got:?}")),
        |((name, expected), (_, got))| (name.to_owned(), expected, got),
    )
}
