//! Identity of a device when a session opens.

use std::fmt;

use softlimb_protocol::{BootCause, Code, DeviceState, HelloReply};

/// Version of a firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FirmwareVersion {
    /// Major number.
    pub major: u8,
    /// Minor number.
    pub minor: u8,
    /// Patch number.
    pub patch: u8,
}

impl fmt::Display for FirmwareVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

/// A device that answered.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceInfo {
    /// Version of its firmware.
    pub firmware: FirmwareVersion,
    /// Protocol version.
    pub protocol_version: u16,
    /// Hash of its interface table.
    pub schema_hash: u32,
    /// Why it last started.
    pub boot_cause: Code<BootCause>,
    /// Its state when it answered.
    pub state: Code<DeviceState>,
    /// Channels it drives at most.
    pub channels_max: u8,
    /// Places in its setpoint buffer.
    pub knots_capacity: u16,
    /// Period of its control tick, us.
    pub tick_us: u32,
    /// Hash of the configuration it held; `None` if it held none.
    pub config_hash: Option<u32>,
    /// Whether another host commands the device. This host is read-only then.
    pub is_occupied: bool,
}

impl From<&HelloReply> for DeviceInfo {
    fn from(reply: &HelloReply) -> Self {
        let firmware =
            FirmwareVersion { major: reply.firmware_major, minor: reply.firmware_minor, patch: reply.firmware_patch };
        Self {
            firmware,
            protocol_version: reply.protocol_version,
            schema_hash: reply.schema_hash,
            boot_cause: reply.boot_cause,
            state: reply.state,
            channels_max: reply.channels_max,
            knots_capacity: reply.knots_capacity,
            tick_us: reply.tick_us,
            config_hash: (reply.config_hash != 0).then_some(reply.config_hash),
            is_occupied: false,
        }
    }
}
