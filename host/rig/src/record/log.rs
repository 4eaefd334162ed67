//! A run as plain data: SI units, no container format, no behaviour.

use super::drawn::DrawnLimb;
use super::solid::{Body, CarriedInfo, SolidInfo};
use crate::link::PortErrors;
use fra_model::StateQuantity;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// One module of the limb: a bundle of actuators of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModuleInfo {
    /// Name in the scene file.
    pub name: String,
    /// Motion in the field's word: extension, expansion, bending, twisting.
    pub motion: String,
    /// Quantity of [`ModuleSample`] for this module.
    #[serde(with = "quantity_name")]
    pub quantity: StateQuantity,
    /// Channels that drive the module, as indices into [`Sample::channels`].
    pub channels: Range<usize>,
    /// Gauge pressure above which the device vents a channel of the module, Pa; `None` in logs of earlier versions and without a scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_limit_pa: Option<f64>,
}

/// One phase of the scene: a move, then a hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhaseInfo {
    /// Name in the scene file.
    pub name: String,
    /// Start, s after the start of the run.
    pub start_s: f64,
    /// Length of the move, s.
    pub move_s: f64,
    /// Length of the hold that follows, s.
    pub hold_s: f64,
    /// Command to the gripper at the end of the move, `open` or `close`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gripper: Option<String>,
    /// Region that the tip is to be in at the end; `None` for other goals, and in logs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// Least clearance of the planned body from the obstacles; `None` without obstacles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestInfo>,
    /// Predicted swing after the move; `None` if the plan is weightless or the simulated limb does not swing, and in logs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub swing: Option<SwingInfo>,
}

/// Predicted swing of the tip after a move.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SwingInfo {
    /// Largest distance of the tip from where it comes to rest, m.
    pub residual_m: f64,
    /// Frequency of the slowest vibration, Hz.
    pub frequency_hz: f64,
}

/// Least clearance of a planned body from the obstacles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NearestInfo {
    /// Name of the obstacle.
    pub obstacle: String,
    /// Distance of the surfaces, m.
    pub distance_m: f64,
    /// When, s after the start of the run.
    pub time_s: f64,
}

impl PhaseInfo {
    /// End of the move, s after the start of the run.
    pub fn hold_start_s(&self) -> f64 {
        self.start_s + self.move_s
    }

    /// End of the hold, s after the start of the run.
    pub fn end_s(&self) -> f64 {
        self.hold_start_s() + self.hold_s
    }
}

/// A fault that the run met on purpose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InjectedFault {
    /// Name, as on the command line.
    pub name: String,
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// Channel, from 0; absent for a fault of no channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<usize>,
}

/// Sensors whose measurements correct the setpoints within a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Observer {
    /// A camera that observes the tip.
    Camera,
    /// IMUs on the end plates of the modules.
    Imus,
}

impl Observer {
    /// Word in log and JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Imus => "imus",
        }
    }
}

/// Everything about a run that is known before it starts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunInfo {
    /// Name of the scene.
    pub scene_name: String,
    /// The scene file, byte for byte.
    pub scene_text: String,
    /// Version of the host tool.
    pub tool_version: String,
    /// Version that the firmware reported.
    pub firmware_version: String,
    /// Hash of the wire interface, equal on both ends.
    pub schema_hash: u32,
    /// Hash of the configuration that the device runs.
    pub config_hash: u32,
    /// Seed of everything random in a simulated run; `None` on a device.
    pub seed: Option<u64>,
    /// When the host began to talk to the device, ns since 1970-01-01 UTC; 0 for a simulated run, so that
    /// equal inputs give equal files.
    pub start_unix_ns: u64,
    /// Modules from the base of the limb to its tip.
    pub modules: Vec<ModuleInfo>,
    /// Phases in order of time.
    pub phases: Vec<PhaseInfo>,
    /// Solids around the limb.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solids: Vec<SolidInfo>,
    /// Least clearance that the scene requires, m; `None` if it requires none, and in logs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance_m: Option<f64>,
    /// Objects that the tip carries, in order of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub carried: Vec<CarriedInfo>,
    /// The limb as viewers draw it; `None` where no scene describes it, and in logs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limb: Option<DrawnLimb>,
    /// True when the device and the limb were simulated.
    pub simulated: bool,
    /// True when the simulated limb carried neither its own weight nor a payload.
    pub weightless: bool,
    /// The simulated limb in words; `None` where it is the planner's with perturbed parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// Sensors whose measurements corrected the setpoints; `None` without feedback.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feedback: Option<Observer>,
    /// Whether the setpoints had the corrections of the scene.
    #[serde(default)]
    pub corrections: bool,
    /// Faults that a simulated run meets on purpose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub injected_faults: Vec<InjectedFault>,
}

impl RunInfo {
    /// Whether the setpoints were corrected. Modules may then leave their planned values, so that the tip follows the plan.
    pub fn is_corrected(&self) -> bool {
        self.feedback.is_some() || self.corrections
    }

    /// Number of pressure channels: one past the last channel of any module.
    pub fn channel_count(&self) -> usize {
        self.modules.iter().map(|module| module.channels.end).max().unwrap_or(0)
    }
}

/// One pressure channel at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChannelSample {
    /// Gauge pressure that the sensor reports, Pa.
    pub pressure_pa: f64,
    /// Gauge pressure that the loop tracks, Pa.
    pub reference_pa: f64,
    /// Share of the control period that a valve is open: + fill, - vent, -1..=1.
    pub duty: f64,
    /// Status bits of the channel, as on the wire.
    pub status: u8,
    /// Gauge pressure in the chamber, Pa, where it is known.
    pub true_pressure_pa: Option<f64>,
}

/// One module at one instant, in the SI unit of its [`StateQuantity`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModuleSample {
    /// Deformation asked for.
    pub setpoint: f64,
    /// Deformation that the controller's model gives at the chamber pressure; at the measured one where the chamber is not seen.
    pub modelled: f64,
    /// Deformation that happened: simulated plant or motion capture.
    pub achieved: Option<f64>,
}

/// The digital outputs at one instant; in logs of earlier builds all are off.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct OutputSample {
    /// Bits as on the wire: bit 0 tells the gripper to close.
    pub bits: u8,
    /// Jaws of the simulated gripper, 0 open to 1 closed.
    pub gripper_closure: Option<f64>,
}

/// The whole limb at one instant. Positions are in the frame of the limb's base.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time, s after the start of the run; negative before it.
    pub time_s: f64,
    /// Device state, as on the wire.
    pub state: u8,
    /// Latched fault bits, as on the wire.
    pub fault_bits: u16,
    /// Gauge pressure of the supply, Pa.
    pub supply_pa: f64,
    /// Voltage of the valves' supply, V; `None` if the board does not sense it, and in logs of earlier versions.
    #[serde(default)]
    pub valve_supply_v: Option<f64>,
    /// Digital outputs.
    #[serde(default)]
    pub outputs: OutputSample,
    /// One entry per channel.
    pub channels: Vec<ChannelSample>,
    /// One entry per module.
    pub modules: Vec<ModuleSample>,
    /// Tip position asked for, m.
    pub tip_setpoint_m: [f64; 3],
    /// Tip position that the model gives at the same pressures, m.
    pub tip_modelled_m: [f64; 3],
    /// Tip position that happened, m.
    pub tip_achieved_m: Option<[f64; 3]>,
}

/// A fault that the device reported, or that was seen on the simulated limb itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// Time, s after the start of the run.
    pub time_s: f64,
    /// Channel, 0xFF for the whole system.
    pub channel: u8,
    /// Fault code, as on the wire; those from 240 on are of the limb and no device has them.
    pub code: u8,
    /// Value that goes with the code.
    pub value: i32,
    /// Meaning of the code, in words.
    pub text: String,
}

impl FaultRecord {
    /// Code of a gripper that opens on the way and drops its payload.
    pub(crate) const DROPPED: u8 = 243;
    /// Code of a gripper that is not closed as the limb goes on.
    pub(crate) const LEFT_BEHIND: u8 = 244;
    /// Code of a part that the operator breaks on purpose.
    pub(crate) const ON_PURPOSE: u8 = 245;

    /// Channel that the device has named; `None` for the whole system, and for a part broken on purpose.
    pub fn reported_channel(&self) -> Option<u8> {
        (self.channel != u8::MAX && self.code != Self::ON_PURPOSE).then_some(self.channel)
    }
}

/// The backbone of the limb at one instant, base to tip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Time, s after the start of the run.
    pub time_s: f64,
    /// Polyline asked for, m.
    pub setpoint: Vec<[f64; 3]>,
    /// Polyline that happened, m.
    pub achieved: Option<Vec<[f64; 3]>>,
}

/// Counters of the link over the whole run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkSummary {
    /// Frames that the host sent, with repetitions.
    pub frames_sent: u64,
    /// Valid frames that the host received.
    pub frames_received: u64,
    /// Bytes that the host sent.
    pub bytes_sent: u64,
    /// Bytes that the host received.
    pub bytes_received: u64,
    /// Frames that the host sent again for want of an acknowledgement.
    pub retransmitted: u64,
    /// Received frames dropped for a wrong checksum.
    pub crc_errors: u64,
    /// Measurements that did not arrive, by the device's times of those that did.
    pub telemetry_lost: u64,
    /// Errors of the device's serial port since its start; `None` where the device told of none during the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port_errors: Option<PortErrors>,
}

/// Data known after a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunEnd {
    /// Link counters.
    pub link: LinkSummary,
    /// Highest true gauge pressure of each channel's chamber, Pa; empty on a device.
    pub peak_chamber_pa: Vec<f64>,
    /// Wall-clock time that the run took, s.
    pub wall_s: Option<f64>,
    /// How the targets were met by hand; empty where nobody moved the limb by hand.
    pub targets: Vec<TargetRecord>,
    /// Obstacles that stopped the simulated limb.
    pub contacts: Vec<ContactRecord>,
}

/// An obstacle that stopped the simulated limb or what it carried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactRecord {
    /// Name of the obstacle.
    pub obstacle: String,
    /// Largest force at a sample, N.
    pub force_n: f64,
    /// Its time, s.
    pub time_s: f64,
    /// Time of the first sample with a contact, s.
    pub first_s: f64,
    /// Whether the carried object alone touched it.
    pub carried: bool,
}

/// How one target was met by hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TargetRecord {
    /// Name of its phase.
    pub name: String,
    /// Time until it was met, s; `None` where it was not.
    pub time_s: Option<f64>,
    /// Least distance of the tip, m; `None` where the tip was never seen on its way there.
    pub least_m: Option<f64>,
    /// Time of the tip at the target, s.
    pub held_s: f64,
}

/// A whole run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunLog {
    /// Data known before the run.
    pub info: RunInfo,
    /// Samples in order of time.
    pub samples: Vec<Sample>,
    /// Faults in order of arrival.
    pub faults: Vec<FaultRecord>,
    /// Backbone shapes in order of time.
    pub shapes: Vec<Shape>,
    /// The limb as a solid in order of time; empty in logs of earlier versions and without an observer.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<Body>,
    /// Link counters; all zero in a log that was cut off.
    pub link: LinkSummary,
    /// Highest true gauge pressure of each channel's chamber, Pa; empty on a device.
    pub peak_chamber_pa: Vec<f64>,
    /// Wall-clock time that the run took, s.
    pub wall_s: Option<f64>,
    /// How the targets were met by hand; empty where nobody moved the limb by hand.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<TargetRecord>,
    /// Obstacles that stopped the simulated limb; empty where none did, or where the simulated limb passes through obstacles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactRecord>,
    /// Why the log ends before the run did; `None` for a finished log.
    pub incomplete: Option<String>,
}

/// A quantity as its name.
pub(crate) mod quantity_name {
    use fra_model::StateQuantity;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives fields by reference")]
    pub(crate) fn serialize<S: Serializer>(quantity: &StateQuantity, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(quantity.name())
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<StateQuantity, D::Error> {
        let name = String::deserialize(deserializer)?;
        let known = StateQuantity::ALL.into_iter().find(|quantity| quantity.name() == name);
        known.ok_or_else(|| Error::custom(format!("no quantity `{name}`")))
    }
}
