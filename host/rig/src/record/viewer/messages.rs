//! Standard ROS messages that viewers draw: transforms, a pose, paths, markers.

use crate::record::cdr::CdrWriter;
use crate::record::drawn::{Pose, WORLD};
use crate::record::messages::{HEADER, MessageType, POINT, QUATERNION, TIME, VECTOR, begin, stamp};

const POSE: (&str, &str) =
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const POSE_STAMPED_TEXT: &str = "std_msgs/Header header\ngeometry_msgs/Pose pose\n";
const COLOR: (&str, &str) = ("std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n");

/// `/robot_description`.
pub(super) const STRING: MessageType = MessageType::new("std_msgs/msg/String", "string data\n", &[]);
/// `/tf` and `/tf_static`.
pub(super) const TF_MESSAGE: MessageType = MessageType::new(
    "tf2_msgs/msg/TFMessage",
    "geometry_msgs/TransformStamped[] transforms\n",
    &[
        (
            "geometry_msgs/TransformStamped",
            "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
        ),
        HEADER,
        TIME,
        ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
        VECTOR,
        QUATERNION,
    ],
);
/// A tip.
pub(super) const POSE_STAMPED: MessageType =
    MessageType::new("geometry_msgs/msg/PoseStamped", POSE_STAMPED_TEXT, &[HEADER, TIME, POSE, POINT, QUATERNION]);
/// The way of a tip.
pub(super) const PATH: MessageType = MessageType::new(
    "nav_msgs/msg/Path",
    "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    &[HEADER, TIME, ("geometry_msgs/PoseStamped", POSE_STAMPED_TEXT), POSE, POINT, QUATERNION],
);
/// Lines and text.
pub(super) const MARKER_ARRAY: MessageType = MessageType::new(
    "visualization_msgs/msg/MarkerArray",
    "visualization_msgs/Marker[] markers\n",
    &[
        ("visualization_msgs/Marker", include_str!("Marker.msg")),
        HEADER,
        TIME,
        ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
        POSE,
        POINT,
        QUATERNION,
        VECTOR,
        COLOR,
        ("sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"),
        ("visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"),
        ("visualization_msgs/MeshFile", "string filename\nuint8[] data\n"),
    ],
);

/// Encodes a text.
pub(super) fn encode_string(text: &str) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    cdr.string(text);
    cdr.into_bytes()
}

/// Encodes frames in the world, each with its pose.
pub(super) fn encode_transforms(unix_ns: u64, frames: &[(String, Pose)]) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    cdr.length(frames.len());
    for (frame, pose) in frames {
        stamp(&mut cdr, unix_ns, WORLD);
        cdr.string(frame);
        posed(&mut cdr, pose);
    }
    cdr.into_bytes()
}

/// Encodes a pose in the world.
pub(super) fn encode_pose(unix_ns: u64, pose: &Pose) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    posed(&mut cdr, pose);
    cdr.into_bytes()
}

/// Encodes places with their times, ns since 1970.
pub(super) fn encode_path(unix_ns: u64, places: impl ExactSizeIterator<Item = (u64, [f64; 3])>) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.length(places.len());
    for (at, position_m) in places {
        stamp(&mut cdr, at, WORLD);
        posed(&mut cdr, &Pose::upright(position_m));
    }
    cdr.into_bytes()
}

/// A position or translation, and a rotation.
fn posed(cdr: &mut CdrWriter, pose: &Pose) {
    cdr.point(pose.position_m);
    pose.rotation.into_iter().for_each(|value| cdr.f64(value));
}

/// A thing drawn in the world.
pub(super) struct Marker<'a> {
    pub(super) namespace: &'a str,
    pub(super) kind: Kind<'a>,
    /// Red, green, blue, opacity.
    pub(super) color: [f32; 4],
    /// Width of a line, or height of letters, m.
    pub(super) size_m: f64,
}

pub(super) enum Kind<'a> {
    /// Points that a line joins, m.
    Line(&'a [[f64; 3]]),
    /// A text at a place, m.
    Text([f64; 3], &'a str),
}

/// Encodes markers. Each replaces the one before of its namespace.
pub(super) fn encode_markers(unix_ns: u64, markers: &[Marker<'_>]) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    cdr.length(markers.len());
    for marker in markers {
        // A line has its width in x, a text its height in z.
        let (kind, place, scale, points, text) = match marker.kind {
            Kind::Line(points) => (4, [0.0; 3], [marker.size_m, 0.0, 0.0], points, ""),
            Kind::Text(place, text) => (9, place, [0.0, 0.0, marker.size_m], &[][..], text),
        };
        stamp(&mut cdr, unix_ns, WORLD);
        cdr.string(marker.namespace);
        // Number, type, and the action of adding.
        [0, kind, 0].into_iter().for_each(|value| cdr.i32(value));
        posed(&mut cdr, &Pose::upright(place));
        cdr.point(scale);
        marker.color.into_iter().for_each(|value| cdr.f32(value));
        // It stays, and its frame does not move.
        [0, 0].into_iter().for_each(|value| cdr.i32(value));
        cdr.u8(0);
        cdr.length(points.len());
        points.iter().for_each(|&point| cdr.point(point));
        // No color of its own for each point, and no texture.
        cdr.length(0);
        cdr.string("");
        stamp(&mut cdr, 0, "");
        cdr.string("");
        [0, 0].into_iter().for_each(|count| cdr.length(count));
        cdr.string(text);
        // No mesh.
        cdr.string("");
        cdr.string("");
        cdr.length(0);
        cdr.u8(0);
    }
    cdr.into_bytes()
}
