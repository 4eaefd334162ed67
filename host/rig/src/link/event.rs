//! Events of a run as they happen.

use softlimb_protocol::{DeviceState, Fault, Samples, Telemetry};

use super::device::DeviceInfo;
use super::statistics::LinkStatistics;

/// Something happened. Host times are the transport's, device times the device's, both in us.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The device answered and speaks the same interface.
    Connected(DeviceInfo),
    /// The device runs on the configuration with this hash.
    Configured {
        /// CRC-32C that names it.
        config_hash: u32,
    },
    /// The device goes to another state.
    State(DeviceState),
    /// The setpoints are buffered and the start is set.
    Armed {
        /// Device time of the start: the zero of the knots' times.
        start_us: u64,
        /// Device time of the last knot.
        end_us: u64,
    },
    /// Measurements.
    Telemetry {
        /// When they arrived, host time.
        host_time_us: u64,
        /// The message.
        message: Telemetry,
    },
    /// Samples between the telemetry messages, if the options request them.
    Samples {
        /// When they arrived, host time.
        host_time_us: u64,
        /// The message.
        message: Samples,
    },
    /// A fault occurred.
    Fault {
        /// When the news arrived, host time.
        host_time_us: u64,
        /// The message.
        message: Fault,
    },
    /// The last knot has passed.
    Finished,
    /// The session ends, well or not: what the link did.
    Closed(LinkStatistics),
}
