//! From setpoints to a device: ports, sessions, streaming. The only room that knows ports.
//!
//! A [`Transport`] is a port with its clock, simulated or real ([`port`]). A [`Session`] is the protocol without either: bytes and times in, bytes and
//! events out. [`stream`] turns the one with the other through a whole run: connect, configure, buffer, start, follow, vent.
//!
//! The buffer of the device bridges the host's pauses: knots carry times of the device's clock, are sent as early as there is room, and are
//! accepted only in order, so that whatever the line loses is sent again and nothing is applied twice.

mod clock;
mod commissioning;
mod configuration;
mod device;
mod direct;
mod disturbance;
mod driver;
mod error;
mod event;
mod fault;
mod listen;
mod live;
mod log;
mod options;
pub mod port;
mod run;
mod sampling;
mod session;
mod simulated;
mod statistics;
mod stream;
mod trajectory;
mod transport;
mod window;
mod words;

pub use clock::ClockMap;
pub use commissioning::{Step, StepKind, Verdict, commission};
pub use configuration::DeviceConfiguration;
pub use device::{DeviceInfo, FirmwareVersion};
pub use direct::Direct;
pub use disturbance::{Disturbances, DisturbedLink, LinkFaultError, LinkFaults};
pub use error::{LinkError, VentOutcome};
pub use event::Event;
pub use fault::DeviceFault;
pub use listen::{Examined, clear_faults, examine, identify, listen, request_samples};
pub(crate) use live::START_US;
pub use live::{Pilot, Wish, live};
pub use log::{DeviceLog, LoggedStart, StartCause, condition_in_words, read_log};
pub use options::StreamOptions;
pub use sampling::{SampleRequest, Sampling, SamplingError, Traffic};
pub use session::{Answer, Session};
pub use statistics::{LinkStatistics, PortErrors, RoundTrip};
pub use stream::{Ending, Summary, stream};
pub use trajectory::Knot;
pub use transport::Transport;
pub use words::{code_name, fault_names, status_names, valve_supply_v};

pub use softlimb_protocol::{Outputs, PulseDirection};
