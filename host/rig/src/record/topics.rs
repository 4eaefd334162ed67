//! The topics of a log, declared once when it is opened.

use super::RunInfo;
use super::messages::{DEFORMATION, FAULT, MessageType, SHAPE, TELEMETRY, TRUTH};
use super::standard::{FLUID_PRESSURE, JOINT_STATE, pressure_topic};
use std::collections::BTreeMap;

/// Numbers under which the container knows the topics of one log.
#[derive(Debug)]
pub(super) struct Topics {
    pub(super) telemetry: u16,
    pub(super) setpoint: u16,
    pub(super) model: u16,
    pub(super) truth: u16,
    pub(super) fault: u16,
    pub(super) shape: u16,
    /// One per pressure channel.
    pub(super) pressure: Vec<u16>,
    /// Setpoint, modelled, achieved.
    pub(super) joints: [u16; 3],
}

impl Topics {
    /// Declares all topics of a run.
    pub(super) fn declare<W: std::io::Write + std::io::Seek>(
        mcap: &mut mcap::Writer<W>,
        info: &RunInfo,
    ) -> mcap::McapResult<Self> {
        let mut declare = |topic: &str, message: MessageType| {
            let schema = mcap.add_schema(message.name, "ros2msg", message.schema().as_bytes())?;
            mcap.add_channel(schema, topic, "cdr", &BTreeMap::new())
        };
        let joints = [
            declare("/softlimb/modules/setpoint", JOINT_STATE)?,
            declare("/softlimb/modules/modelled", JOINT_STATE)?,
            declare("/softlimb/modules/achieved", JOINT_STATE)?,
        ];
        Ok(Self {
            telemetry: declare(super::TELEMETRY_TOPIC, TELEMETRY)?,
            setpoint: declare(super::SETPOINT_TOPIC, DEFORMATION)?,
            model: declare(super::MODEL_TOPIC, DEFORMATION)?,
            truth: declare(super::TRUTH_TOPIC, TRUTH)?,
            fault: declare(super::FAULT_TOPIC, FAULT)?,
            shape: declare(super::SHAPE_TOPIC, SHAPE)?,
            pressure: (0..info.channel_count())
                .map(|channel| declare(&pressure_topic(channel), FLUID_PRESSURE))
                .collect::<Result<_, _>>()?,
            joints,
        })
    }
}
