//! The messages of package `softlimb_msgs`: type names, definitions, and the way
//! between them and the plain data of [`super::log`].

use super::cdr::{CdrError, CdrReader, CdrWriter};
use super::drawn::WORLD;
use super::{Body, ChannelSample, FaultRecord, OutputSample, Sample, Shape};

/// Between two definitions of one `ros2msg` schema.
const SEPARATOR: &str = "================================================================================";

/// A message type: its full name and its definition with everything it refers to.
#[derive(Debug, Clone, Copy)]
pub(super) struct MessageType {
    /// `package/msg/Name`.
    pub(super) name: &'static str,
    definition: &'static str,
    uses: &'static [(&'static str, &'static str)],
}

impl MessageType {
    /// A type from its name, its own definition and those that it refers to.
    pub(super) const fn new(
        name: &'static str,
        definition: &'static str,
        uses: &'static [(&'static str, &'static str)],
    ) -> Self {
        Self { name, definition, uses }
    }

    /// The schema text as `ros2msg` wants it.
    pub(super) fn schema(&self) -> String {
        let mut text = self.definition.to_owned();
        for (name, definition) in self.uses {
            text.push_str(&format!("{SEPARATOR}\nMSG: {name}\n{definition}"));
        }
        text
    }

    /// Whether a schema text has the fields of this type: comments may differ, as they do between builds.
    pub(super) fn has_fields_of(&self, text: &[u8]) -> bool {
        let Ok(text) = std::str::from_utf8(text) else { return false };
        let own = self.schema();
        fields(text).eq(fields(&own))
    }
}

/// The lines of a schema text without comments and spaces around them.
fn fields(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(|line| line.split('#').next().unwrap_or_default().trim_end()).filter(|line| !line.is_empty())
}

/// `std_msgs/Header`, the first field of every message here.
pub(super) const HEADER: (&str, &str) = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
/// `builtin_interfaces/Time`, part of the header.
pub(super) const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
/// `geometry_msgs/Point`, a position.
pub(super) const POINT: (&str, &str) = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
/// `geometry_msgs/Vector3`, a direction or a rate.
pub(super) const VECTOR: (&str, &str) = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
/// `geometry_msgs/Quaternion`, an orientation.
pub(super) const QUATERNION: (&str, &str) =
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");

/// `/softlimb/telemetry`.
pub(super) const TELEMETRY: MessageType =
    MessageType::new("softlimb_msgs/msg/Telemetry", include_str!("msg/Telemetry.msg"), &[HEADER, TIME]);
/// `/softlimb/setpoint` and `/softlimb/model`.
pub(super) const DEFORMATION: MessageType =
    MessageType::new("softlimb_msgs/msg/Deformation", include_str!("msg/Deformation.msg"), &[HEADER, TIME, POINT]);
/// `/softlimb/truth`.
pub(super) const TRUTH: MessageType =
    MessageType::new("softlimb_msgs/msg/Truth", include_str!("msg/Truth.msg"), &[HEADER, TIME, POINT]);
/// `/softlimb/fault`.
pub(super) const FAULT: MessageType =
    MessageType::new("softlimb_msgs/msg/Fault", include_str!("msg/Fault.msg"), &[HEADER, TIME]);
/// `/softlimb/outputs`.
pub(super) const OUTPUTS: MessageType =
    MessageType::new("softlimb_msgs/msg/Outputs", include_str!("msg/Outputs.msg"), &[HEADER, TIME]);
/// `/softlimb/camera`.
pub(super) const POINT_STAMPED: MessageType = MessageType::new(
    "geometry_msgs/msg/PointStamped",
    "std_msgs/Header header\ngeometry_msgs/Point point\n",
    &[HEADER, TIME, POINT],
);
/// `/softlimb/shape`.
pub(super) const SHAPE: MessageType =
    MessageType::new("softlimb_msgs/msg/Shape", include_str!("msg/Shape.msg"), &[HEADER, TIME, POINT]);
/// `/softlimb/body`.
pub(super) const BODY: MessageType =
    MessageType::new("softlimb_msgs/msg/Body", include_str!("msg/Body.msg"), &[HEADER, TIME, POINT]);
/// `/softlimb/wire`.
pub(super) const WIRE: MessageType =
    MessageType::new("softlimb_msgs/msg/Wire", include_str!("msg/Wire.msg"), &[HEADER, TIME]);
/// `/softlimb/samples`.
pub(super) const SAMPLES: MessageType =
    MessageType::new("softlimb_msgs/msg/Samples", include_str!("msg/Samples.msg"), &[HEADER, TIME]);
/// `/softlimb/ticks`.
pub(super) const TICKS: MessageType =
    MessageType::new("softlimb_msgs/msg/Ticks", include_str!("msg/Ticks.msg"), &[HEADER, TIME]);

/// Starts a message with its header.
pub(super) fn begin(unix_ns: u64) -> CdrWriter {
    let mut cdr = CdrWriter::new();
    stamp(&mut cdr, unix_ns, WORLD);
    cdr
}

/// Appends a header.
pub(super) fn stamp(cdr: &mut CdrWriter, unix_ns: u64, frame: &str) {
    const NS_PER_S: u64 = 1_000_000_000;
    // `builtin_interfaces/Time` holds i32 seconds: it ends in 2038.
    cdr.i32(i32::try_from(unix_ns / NS_PER_S).unwrap_or(i32::MAX));
    cdr.u32((unix_ns % NS_PER_S) as u32);
    cdr.string(frame);
}

/// Opens a message and passes over its header.
pub(super) fn open(message: &[u8]) -> Result<CdrReader<'_>, CdrError> {
    let mut cdr = CdrReader::new(message)?;
    cdr.i32()?;
    cdr.u32()?;
    cdr.string()?;
    Ok(cdr)
}

/// Encodes what the device reported.
pub(super) fn encode_telemetry(unix_ns: u64, sample: &Sample) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(sample.time_s);
    cdr.u8(sample.state);
    cdr.u16(sample.fault_bits);
    cdr.f64(sample.supply_pa);
    cdr.f64_sequence(sample.channels.iter().map(|channel| channel.pressure_pa));
    cdr.f64_sequence(sample.channels.iter().map(|channel| channel.reference_pa));
    cdr.f64_sequence(sample.channels.iter().map(|channel| channel.duty));
    cdr.length(sample.channels.len());
    sample.channels.iter().for_each(|channel| cdr.u8(channel.status));
    cdr.f64(sample.valve_supply_v.unwrap_or(f64::NAN));
    cdr.into_bytes()
}

/// Decodes what the device reported; modules and tip are still empty.
pub(super) fn decode_telemetry(message: &[u8]) -> Result<Sample, CdrError> {
    let mut cdr = open(message)?;
    let (time_s, state, fault_bits, supply_pa) = (cdr.f64()?, cdr.u8()?, cdr.u16()?, cdr.f64()?);
    let pressure = cdr.sequence(CdrReader::f64)?;
    let reference = cdr.sequence(CdrReader::f64)?;
    let duty = cdr.sequence(CdrReader::f64)?;
    let status = cdr.sequence(CdrReader::u8)?;
    // Logs of earlier versions end before it.
    let valve_supply_v = cdr.f64().ok().filter(|volts| !volts.is_nan());
    let channels = pressure.iter().zip(&reference).zip(&duty).zip(&status).map(
        |(((&pressure_pa, &reference_pa), &duty), &status)| ChannelSample {
            pressure_pa,
            reference_pa,
            duty,
            status,
            true_pressure_pa: None,
        },
    );
    Ok(Sample {
        time_s,
        state,
        fault_bits,
        supply_pa,
        valve_supply_v,
        outputs: OutputSample::default(),
        channels: channels.collect(),
        modules: Vec::new(),
        tip_setpoint_m: [0.0; 3],
        tip_modelled_m: [0.0; 3],
        tip_achieved_m: None,
    })
}

/// Encodes the digital outputs.
pub(super) fn encode_outputs(unix_ns: u64, time_s: f64, outputs: &OutputSample) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(time_s);
    cdr.u8(outputs.bits);
    cdr.f64(outputs.gripper_closure.unwrap_or(f64::NAN));
    cdr.into_bytes()
}

/// Decodes the digital outputs.
pub(super) fn decode_outputs(message: &[u8]) -> Result<OutputSample, CdrError> {
    let mut cdr = open(message)?;
    cdr.f64()?;
    let (bits, closure) = (cdr.u8()?, cdr.f64()?);
    Ok(OutputSample { bits, gripper_closure: (!closure.is_nan()).then_some(closure) })
}

/// Encodes module deformations and the tip.
pub(super) fn encode_deformation(
    unix_ns: u64,
    modules: impl ExactSizeIterator<Item = f64>,
    tip_m: [f64; 3],
) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64_sequence(modules);
    cdr.point(tip_m);
    cdr.into_bytes()
}

/// Decodes module deformations and the tip.
pub(super) fn decode_deformation(message: &[u8]) -> Result<(Vec<f64>, [f64; 3]), CdrError> {
    let mut cdr = open(message)?;
    Ok((cdr.sequence(CdrReader::f64)?, cdr.point()?))
}

/// Observed state at one instant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Truth {
    /// Chamber pressures, Pa.
    pub(super) pressure_pa: Vec<Option<f64>>,
    /// Module deformations, SI.
    pub(super) modules: Vec<Option<f64>>,
    /// Tip position, m.
    pub(super) tip_m: Option<[f64; 3]>,
}

impl Truth {
    /// The truth in a sample, `None` when it holds none.
    pub(super) fn of(sample: &Sample) -> Option<Self> {
        let truth = Self {
            pressure_pa: sample.channels.iter().map(|channel| channel.true_pressure_pa).collect(),
            modules: sample.modules.iter().map(|module| module.achieved).collect(),
            tip_m: sample.tip_achieved_m,
        };
        let mut values = truth.pressure_pa.iter().chain(&truth.modules);
        (truth.tip_m.is_some() || values.any(Option::is_some)).then_some(truth)
    }

    /// Encodes the truth.
    pub(super) fn encode(&self, unix_ns: u64) -> Vec<u8> {
        let mut cdr = begin(unix_ns);
        cdr.f64_sequence(self.pressure_pa.iter().map(|value| value.unwrap_or(f64::NAN)));
        cdr.f64_sequence(self.modules.iter().map(|value| value.unwrap_or(f64::NAN)));
        cdr.point(self.tip_m.unwrap_or([f64::NAN; 3]));
        cdr.into_bytes()
    }

    /// Decodes the truth.
    pub(super) fn decode(message: &[u8]) -> Result<Self, CdrError> {
        let observed = |value: f64| (!value.is_nan()).then_some(value);
        let mut cdr = open(message)?;
        let pressure_pa = cdr.sequence(|cdr| cdr.f64().map(observed))?;
        let modules = cdr.sequence(|cdr| cdr.f64().map(observed))?;
        let tip = cdr.point()?;
        let tip_m = (!tip.iter().any(|value| value.is_nan())).then_some(tip);
        Ok(Self { pressure_pa, modules, tip_m })
    }
}

/// Encodes a fault.
pub(super) fn encode_fault(unix_ns: u64, fault: &FaultRecord) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(fault.time_s);
    cdr.u8(fault.channel);
    cdr.u8(fault.code);
    cdr.i32(fault.value);
    cdr.string(&fault.text);
    cdr.into_bytes()
}

/// Decodes a fault.
pub(super) fn decode_fault(message: &[u8]) -> Result<FaultRecord, CdrError> {
    let mut cdr = open(message)?;
    Ok(FaultRecord { time_s: cdr.f64()?, channel: cdr.u8()?, code: cdr.u8()?, value: cdr.i32()?, text: cdr.string()? })
}

/// Encodes a position.
pub(super) fn encode_point(unix_ns: u64, position_m: [f64; 3]) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.point(position_m);
    cdr.into_bytes()
}

/// Encodes a backbone.
pub(super) fn encode_shape(unix_ns: u64, shape: &Shape) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(shape.time_s);
    for polyline in [Some(&shape.setpoint), shape.achieved.as_ref()] {
        let points = polyline.map(Vec::as_slice).unwrap_or_default();
        cdr.length(points.len());
        points.iter().for_each(|&point| cdr.point(point));
    }
    cdr.into_bytes()
}

/// Decodes a backbone.
pub(super) fn decode_shape(message: &[u8]) -> Result<Shape, CdrError> {
    let mut cdr = open(message)?;
    let time_s = cdr.f64()?;
    let setpoint = cdr.sequence(CdrReader::point)?;
    let achieved = cdr.sequence(CdrReader::point)?;
    Ok(Shape { time_s, setpoint, achieved: (!achieved.is_empty()).then_some(achieved) })
}

/// Encodes the limb as a solid.
pub(super) fn encode_body(unix_ns: u64, body: &Body) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(body.time_s);
    cdr.length(body.line_m.len());
    body.line_m.iter().for_each(|&point| cdr.point(point));
    cdr.f64_sequence(body.radius_m.iter().copied());
    let (distance_m, obstacle) = body.nearest.as_ref().map_or((f64::NAN, ""), |(at, name)| (*at, name.as_str()));
    cdr.f64(distance_m);
    cdr.string(obstacle);
    cdr.point(body.tip_unloaded_m.unwrap_or([f64::NAN; 3]));
    cdr.into_bytes()
}

/// Decodes the limb as a solid.
pub(super) fn decode_body(message: &[u8]) -> Result<Body, CdrError> {
    let mut cdr = open(message)?;
    let time_s = cdr.f64()?;
    let (line_m, radius_m) = (cdr.sequence(CdrReader::point)?, cdr.sequence(CdrReader::f64)?);
    let (distance_m, obstacle) = (cdr.f64()?, cdr.string()?);
    let tip = cdr.point()?;
    let nearest = (!distance_m.is_nan()).then_some((distance_m, obstacle));
    let tip_unloaded_m = (!tip.iter().any(|value| value.is_nan())).then_some(tip);
    Ok(Body { time_s, line_m, radius_m, nearest, tip_unloaded_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemas_with_other_comments_have_the_same_fields() {
        let text = SHAPE.schema();
        assert!(text.contains("# Backbone") && SHAPE.has_fields_of(text.as_bytes()));
        let other = text.replace("# Backbone", "# The backbone").replace("  # empty", "   # none");
        assert!(other != text && SHAPE.has_fields_of(other.as_bytes()));
        assert!(!SHAPE.has_fields_of(text.replace("setpoint", "desired").as_bytes()));
        assert!(!SHAPE.has_fields_of(BODY.schema().as_bytes()) && !SHAPE.has_fields_of(&[0xff]));
    }
}
