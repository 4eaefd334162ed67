//! The topics of a log, declared once when it is opened.

use super::RunInfo;
use super::messages::{
    BODY, DEFORMATION, FAULT, MessageType, OUTPUTS, POINT_STAMPED, SAMPLES, SHAPE, TELEMETRY, TICKS, TRUTH, WIRE,
};
use super::standard::{FLUID_PRESSURE, IMU, JOINT_STATE, pressure_topic};
use std::collections::BTreeMap;

/// Numbers under which the container knows the topics of one log.
#[derive(Debug)]
pub(super) struct Topics {
    pub(super) telemetry: u16,
    pub(super) setpoint: u16,
    pub(super) model: u16,
    pub(super) fault: u16,
    pub(super) outputs: u16,
    pub(super) shape: u16,
    pub(super) wire: u16,
    /// Topic of the ticks; `None` before the first: only simulated and emulated devices show ticks.
    pub(super) ticks: Option<u16>,
    /// Topic of samples; `None` before the first: only a host that requests them gets any.
    pub(super) samples: Option<u16>,
    /// Topic of images; `None` before the first: only scenes with a camera have any.
    pub(super) camera: Option<u16>,
    /// Topic of readings of IMUs; `None` before the first: only scenes with IMUs have any.
    pub(super) imu: Option<u16>,
    /// One per pressure channel.
    pub(super) pressure: Vec<u16>,
    /// Setpoint, modelled.
    pub(super) joints: [u16; 2],
    /// Those of what somebody saw; `None` until the first time.
    pub(super) observed: Option<Observed>,
}

/// Numbers of the topics of a limb that somebody sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observed {
    pub(super) truth: u16,
    pub(super) achieved: u16,
    pub(super) body: u16,
}

impl Observed {
    /// Declares the topics of a limb that is seen.
    pub(super) fn declare<W: std::io::Write + std::io::Seek>(mcap: &mut mcap::Writer<W>) -> mcap::McapResult<Self> {
        Ok(Self {
            truth: declare(mcap, super::TRUTH_TOPIC, TRUTH)?,
            achieved: declare(mcap, "/softlimb/modules/achieved", JOINT_STATE)?,
            body: declare(mcap, super::BODY_TOPIC, BODY)?,
        })
    }
}

/// Declares the topic of the ticks.
pub(super) fn declare_ticks<W: std::io::Write + std::io::Seek>(mcap: &mut mcap::Writer<W>) -> mcap::McapResult<u16> {
    declare(mcap, super::TICKS_TOPIC, TICKS)
}

/// Declares the topic of samples.
pub(super) fn declare_samples<W: std::io::Write + std::io::Seek>(mcap: &mut mcap::Writer<W>) -> mcap::McapResult<u16> {
    declare(mcap, super::SAMPLES_TOPIC, SAMPLES)
}

/// Declares the topic of images.
pub(super) fn declare_camera<W: std::io::Write + std::io::Seek>(mcap: &mut mcap::Writer<W>) -> mcap::McapResult<u16> {
    declare(mcap, super::CAMERA_TOPIC, POINT_STAMPED)
}

/// Declares the topic of the IMUs.
pub(super) fn declare_imu<W: std::io::Write + std::io::Seek>(mcap: &mut mcap::Writer<W>) -> mcap::McapResult<u16> {
    declare(mcap, super::IMU_TOPIC, IMU)
}

fn declare<W: std::io::Write + std::io::Seek>(
    mcap: &mut mcap::Writer<W>,
    topic: &str,
    message: MessageType,
) -> mcap::McapResult<u16> {
    let schema = mcap.add_schema(message.name, "ros2msg", message.schema().as_bytes())?;
    mcap.add_channel(schema, topic, "cdr", &BTreeMap::new())
}

impl Topics {
    /// Declares the topics that every run has.
    pub(super) fn declare<W: std::io::Write + std::io::Seek>(
        mcap: &mut mcap::Writer<W>,
        info: &RunInfo,
    ) -> mcap::McapResult<Self> {
        let mut declare = |topic: &str, message| declare(mcap, topic, message);
        let joints =
            [declare("/softlimb/modules/setpoint", JOINT_STATE)?, declare("/softlimb/modules/modelled", JOINT_STATE)?];
        Ok(Self {
            telemetry: declare(super::TELEMETRY_TOPIC, TELEMETRY)?,
            setpoint: declare(super::SETPOINT_TOPIC, DEFORMATION)?,
            model: declare(super::MODEL_TOPIC, DEFORMATION)?,
            fault: declare(super::FAULT_TOPIC, FAULT)?,
            outputs: declare(super::OUTPUTS_TOPIC, OUTPUTS)?,
            shape: declare(super::SHAPE_TOPIC, SHAPE)?,
            wire: declare(super::WIRE_TOPIC, WIRE)?,
            ticks: None,
            samples: None,
            camera: None,
            imu: None,
            pressure: (0..info.channel_count())
                .map(|channel| declare(&pressure_topic(channel), FLUID_PRESSURE))
                .collect::<Result<_, _>>()?,
            joints,
            observed: None,
        })
    }
}
