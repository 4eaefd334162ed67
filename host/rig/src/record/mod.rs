//! Run logs: one MCAP file per run that Foxglove, PlotJuggler, rosbags and plain
//! Python open without our code.
//!
//! [`Recorder`] writes a run while it happens, [`read`] brings the whole run back
//! as a [`RunLog`] of plain data. The byte layout is described in
//! `docs/reference/log.md`. This is the only room that knows the container format;
//! it knows nothing of ports, scenes or figures.

mod background;
mod cdr;
mod container;
mod drawn;
mod error;
mod log;
mod messages;
mod metadata;
mod reader;
mod recover;
mod samples;
mod solid;
mod standard;
mod ticks;
mod topics;
mod viewer;
mod wire;
mod writer;

pub use drawn::{DrawnLimb, DrawnLink, Pose, Posture};
pub use error::RecordError;
pub(crate) use log::quantity_name;
pub use log::{
    ChannelSample, ContactRecord, FaultRecord, InjectedFault, LinkSummary, ModuleInfo, ModuleSample, NearestInfo,
    Observer, OutputSample, PhaseInfo, RunEnd, RunInfo, RunLog, Sample, Shape, SwingInfo, TargetRecord,
};
pub use reader::read;
pub use recover::{Recovered, recover};
pub use samples::SampleRow;
pub use solid::{Body, CarriedInfo, SolidInfo, SolidShape};
pub use ticks::{CoilPulse, DeviceTick};
pub use viewer::description;
pub use wire::{Capture, Direction, WireBytes, read_capture};
pub use writer::Recorder;

/// Version of the log layout, kept in the run metadata. A reader refuses others.
const FORMAT_VERSION: &str = "1";
/// Name of the metadata record that opens every log.
const RUN_METADATA: &str = "softlimb.run";
/// Name of the metadata record that only a finished log has.
const END_METADATA: &str = "softlimb.end";
/// Name of the metadata record that a recovered log has.
const RECOVERED_METADATA: &str = "softlimb.recovered";
/// Name of the attachment that carries the scene file.
const SCENE_ATTACHMENT: &str = "scene.toml";

const TELEMETRY_TOPIC: &str = "/softlimb/telemetry";
const SETPOINT_TOPIC: &str = "/softlimb/setpoint";
const MODEL_TOPIC: &str = "/softlimb/model";
const TRUTH_TOPIC: &str = "/softlimb/truth";
const FAULT_TOPIC: &str = "/softlimb/fault";
const OUTPUTS_TOPIC: &str = "/softlimb/outputs";
const WIRE_TOPIC: &str = "/softlimb/wire";
const SAMPLES_TOPIC: &str = "/softlimb/samples";
const CAMERA_TOPIC: &str = "/softlimb/camera";
const IMU_TOPIC: &str = "/softlimb/imu";
const TICKS_TOPIC: &str = "/softlimb/ticks";
const SHAPE_TOPIC: &str = "/softlimb/shape";
const BODY_TOPIC: &str = "/softlimb/body";
