//! Errors between host and device, in words for the person at the bench.

use std::fmt;
use std::io;

use softlimb_protocol::{
    Ack, Code, ConfigChannel, ConfigInverse, ConfigVolume, DeviceState, FaultCode, HostMessage, Message,
    PROTOCOL_VERSION, ResultCode, SCHEMA_HASH,
};

use super::device::FirmwareVersion;
use super::fault::{DeviceFault, name};

/// Why a run did not happen or did not end well.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The operating system reports an error of the port.
    #[error("the port failed: {0}")]
    Port(#[from] io::Error),
    /// A reliable message was never answered.
    #[error("no answer to {message}: is the device connected and switched on?")]
    NoAnswer {
        /// Name of the message.
        message: &'static str,
    },
    /// A device sends no measurements.
    #[error(
        "no measurements for {} ms: the device is off, or has no configuration; `--scene SCENE` gives it one",
        waited_us / 1_000
    )]
    NoTelemetry {
        /// Time since the last, or since the beginning, us.
        waited_us: u64,
    },
    /// A connected device fell silent.
    #[error("the device has been silent for {} ms: the link is lost", silence_us / 1_000)]
    Silent {
        /// Time since its last valid frame, us.
        silence_us: u64,
    },
    /// The firmware speaks another version of the interface.
    #[error(
        "firmware {firmware} speaks protocol {version} with schema {hash:08x}, this program protocol {PROTOCOL_VERSION} with schema \
         {SCHEMA_HASH:08x}: install matching versions"
    )]
    Incompatible {
        /// Version of the firmware.
        firmware: FirmwareVersion,
        /// Its protocol version.
        version: u16,
        /// Its schema hash.
        hash: u32,
    },
    /// Another host talks to the device.
    #[error("another program controls the device")]
    Occupied,
    /// The device does not know the session any more.
    #[error("the device no longer knows this session: it was reset, or another program took over")]
    DeviceRestarted,
    /// No channel, or more than the device has.
    #[error("{count} channels are configured; the device takes 1 to {max}")]
    ChannelCount {
        /// Channels of the configuration.
        count: usize,
        /// Channels of the device or the wire.
        max: usize,
    },
    /// There is nothing to do.
    #[error("the trajectory has no setpoints")]
    EmptyTrajectory,
    /// A knot has another number of values than the configuration has channels.
    #[error("setpoint {index} has {count} values for {channels} channels")]
    KnotValues {
        /// The knot, from 0.
        index: usize,
        /// Its values.
        count: usize,
        /// Channels of the configuration.
        channels: usize,
    },
    /// A knot does not come after the one before.
    #[error("setpoint {index} is not later than the one before")]
    KnotTime {
        /// The knot, from 0.
        index: usize,
    },
    /// The buffer of the device covers too short a time.
    #[error(
        "the setpoints are too dense: {capacity} of them, all the device buffers, cover {} ms; {} ms are needed to bridge a pause of \
         the host",
        span_us / 1_000, needed_us / 1_000
    )]
    TooDense {
        /// Places in the device's buffer.
        capacity: u16,
        /// The shortest time that so many knots cover, us.
        span_us: u64,
        /// The shortest time accepted, us.
        needed_us: u64,
    },
    /// The device refuses a reliable message.
    #[error("the device refuses {message}: {reason}")]
    Refused {
        /// Name of the message.
        message: &'static str,
        /// In words, with the field or fault where the device names one.
        reason: String,
    },
    /// The device refuses a setpoint.
    #[error("the device refuses setpoint {index}: {}", knot_reason(*result, *detail))]
    KnotRefused {
        /// The knot, or the first of those in its frame, from 0.
        index: u32,
        /// Why.
        result: Code<ResultCode>,
        /// Channel or count, by the reason.
        detail: u32,
    },
    /// The device expects a setpoint that it has accepted before.
    #[error("the device dropped setpoints it had accepted: it was flushed or configured by someone else")]
    SetpointsDropped,
    /// A fault from before is latched.
    #[error(
        "the device holds a fault from before ({}); find its cause, then `softlimb device clear`",
        fault_or_unknown(fault)
    )]
    LatchedFault {
        /// The fault, if the device told.
        fault: Option<DeviceFault>,
    },
    /// A configured device does not become ready.
    #[error("the device is not ready after {} ms ({}; {})", waited_us / 1_000, in_words(*state), fault_or_unknown(fault))]
    NotReady {
        /// Time waited, us.
        waited_us: u64,
        /// Its state.
        state: Option<DeviceState>,
        /// Its fault, if it reported one.
        fault: Option<DeviceFault>,
    },
    /// The reservoir does not reach the pressure needed.
    #[error("the supply is at {:.1} kPa after {} s; {:.1} kPa are needed", found_pa * 1e-3, waited_us / 1_000_000, needed_pa * 1e-3)]
    NoSupply {
        /// Gauge pressure of the supply, Pa.
        found_pa: f64,
        /// Lowest gauge pressure for running, Pa.
        needed_pa: f64,
        /// Time waited, us.
        waited_us: u64,
    },
    /// The setpoints never reached the device before their start.
    #[error("the link is too slow: the first setpoints did not arrive in time in {attempts} attempts")]
    TooSlow {
        /// Attempts made.
        attempts: u32,
    },
    /// The device accepted a start and did not begin.
    #[error("the device accepted the start but did not begin ({})", fault_or_unknown(fault))]
    NotStarted {
        /// Its fault, if it reported one.
        fault: Option<DeviceFault>,
    },
    /// The device has a fault.
    #[error("the device stopped: {}", fault_or_unknown(fault))]
    Fault {
        /// The fault, if the device told.
        fault: Option<DeviceFault>,
    },
    /// The device ran out of setpoints before the end.
    #[error("the device ran out of setpoints after {accepted} of {total}: the link was interrupted for too long")]
    Starved {
        /// Setpoints that arrived.
        accepted: u32,
        /// Setpoints in all.
        total: u32,
    },
    /// The device left its trajectory without a fault.
    #[error("the device is {} before the end", in_words(*state))]
    Stopped {
        /// Its state.
        state: Option<DeviceState>,
    },
    /// The pressures do not go down.
    #[error("the limb is still under pressure {} s after venting began", waited_us / 1_000_000)]
    StillPressurized {
        /// Time waited, us.
        waited_us: u64,
    },
    /// The user stopped the run.
    #[error("canceled")]
    Canceled,
    /// Any of the above after the device was configured: when, and what was done about it.
    #[error("{}{cause}; {vent}", run_time(*at_us))]
    Run {
        /// Time since the start of the trajectory, us; `None` if it had not started.
        at_us: Option<u64>,
        /// Outcome of venting.
        vent: VentOutcome,
        /// Cause.
        #[source]
        cause: Box<LinkError>,
    },
}

/// Outcome of venting when a run is given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VentOutcome {
    /// The device confirmed that it vents.
    Venting,
    /// The device lets the pressure down by itself, as its configuration says for faults.
    ByDevice,
    /// No answer: the device follows its link-loss policy.
    Unconfirmed,
}

impl fmt::Display for VentOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Venting => "the limb is being vented",
            Self::ByDevice => "the device handles the pressures by its fault policy",
            Self::Unconfirmed => "venting is not confirmed: the device acts by its link-loss policy",
        })
    }
}

impl LinkError {
    /// The refusal of a reliable message.
    /// `state` is the state in the device's latest message.
    pub(super) fn refused(message: &HostMessage, ack: &Ack, state: Option<DeviceState>) -> Self {
        if ack.result == ResultCode::WrongSession {
            return Self::DeviceRestarted;
        }
        let detail = ack.detail as usize;
        let field = layout(message.message_type()).and_then(|layout| layout.fields.get(detail)).map_or("?", |f| f.name);
        let reason = match ack.result.known() {
            Some(ResultCode::OutOfRange) => format!("{field} is out of range{}", channel_of(message)),
            Some(ResultCode::UnknownCode) => format!("{field} holds an unknown code{}", channel_of(message)),
            Some(ResultCode::WrongState) if (1..=255).contains(&ack.detail) => {
                format!("{} (it is {})", name(Code::<FaultCode>::from_raw(ack.detail as u8)), in_words(state))
            }
            Some(ResultCode::WrongState) => format!("it is {}; {}", in_words(state), way_out(state)),
            Some(ResultCode::ConfigMismatch) => "the upload is incomplete or was damaged".to_owned(),
            Some(ResultCode::TablesMissing) => {
                format!("channel {detail} has no tables, and the device does not solve the model of its actuator")
            }
            Some(ResultCode::Late) => "the time has passed".to_owned(),
            _ => format!("result {:?}, detail {}", ack.result, ack.detail),
        };
        Self::Refused { message: message_name(message.message_type()), reason }
    }
}

/// The name of a host message in the interface table.
pub(super) fn message_name(message_type: u8) -> &'static str {
    layout(message_type).map_or("an unknown message", |layout| layout.name)
}

fn layout(message_type: u8) -> Option<&'static softlimb_protocol::MessageLayout> {
    HostMessage::LAYOUT.iter().find(|layout| layout.message_type == message_type)
}

fn channel_of(message: &HostMessage) -> String {
    match message {
        HostMessage::ConfigChannel(ConfigChannel { channel, .. })
        | HostMessage::ConfigVolume(ConfigVolume { channel, .. })
        | HostMessage::ConfigInverse(ConfigInverse { channel, .. }) => format!(" on channel {channel}"),
        _ => String::new(),
    }
}

fn knot_reason(result: Code<ResultCode>, detail: u32) -> String {
    match result.known() {
        Some(ResultCode::OutOfRange) => format!("channel {detail} cannot take its value"),
        Some(ResultCode::Late) => "it arrived after its time".to_owned(),
        Some(ResultCode::TooFast) => format!("channel {detail} would cross its limits in less than 100 ms"),
        Some(ResultCode::BeyondHorizon) => format!("its time is more than {:.0} s ahead", f64::from(detail) * 1e-6),
        Some(ResultCode::WrongChannelCount) => format!("the device has {detail} channels"),
        _ => format!("result {result:?}, detail {detail}"),
    }
}

fn in_words(state: Option<DeviceState>) -> &'static str {
    match state {
        Some(DeviceState::Idle) => "idle",
        Some(DeviceState::Ready) => "ready",
        Some(DeviceState::Running) => "running",
        Some(DeviceState::Holding) => "holding",
        Some(DeviceState::Venting) => "venting",
        Some(DeviceState::Faulted) => "faulted",
        None => "in an unknown state",
    }
}

/// Advice to a user whose device refuses a message in its present state.
fn way_out(state: Option<DeviceState>) -> &'static str {
    match state {
        Some(DeviceState::Idle) => {
            "it becomes ready once it is configured, its sensors are plausible and the emergency stop is released"
        }
        Some(DeviceState::Ready) => "send this while it runs or holds",
        Some(DeviceState::Running) => "end the run, or wait for its end",
        Some(DeviceState::Holding) => "let the pressures down with `softlimb device vent`",
        Some(DeviceState::Venting) => "wait until it is ready",
        Some(DeviceState::Faulted) => "find the cause of its fault, then `softlimb device clear`",
        None => "ask it with `softlimb device info`",
    }
}

fn fault_or_unknown(fault: &Option<DeviceFault>) -> String {
    fault.map_or_else(|| "it did not say why".to_owned(), |fault| fault.to_string())
}

fn run_time(at_us: Option<u64>) -> String {
    at_us.map_or_else(String::new, |at_us| format!("{:.3} s into the run, ", at_us as f64 * 1e-6))
}
