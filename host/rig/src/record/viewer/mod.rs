//! Topics that rerun, Foxglove and RViz draw without knowing our types. Written only: `softlimb` does not read them.

mod description;
mod frames;
mod messages;

use super::drawn::BASE;
use super::messages::MessageType;
use super::{Body, DrawnLimb, FaultRecord, Pose, Posture, RunInfo, Sample, Shape};
use description::urdf;
use frames::{carried_frame, solid_frame, solid_pose};
use messages::{
    Kind, MARKER_ARRAY, Marker, PATH, POSE_STAMPED, STRING, TF_MESSAGE, encode_markers, encode_path, encode_pose,
    encode_string, encode_transforms,
};
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;

const DESCRIPTION_TOPIC: &str = "/robot_description";
const STATIC_TOPIC: &str = "/tf_static";
const MOVING_TOPIC: &str = "/tf";
const TIP_TOPIC: &str = "/softlimb/tip";
const PLAN_TOPIC: &str = "/softlimb/path/setpoint";
const TRAIL_TOPIC: &str = "/softlimb/path/tip";
const MARKERS_TOPIC: &str = "/softlimb/markers";

/// All of them.
pub(super) const TOPICS: [&str; 7] =
    [DESCRIPTION_TOPIC, STATIC_TOPIC, MOVING_TOPIC, TIP_TOPIC, PLAN_TOPIC, TRAIL_TOPIC, MARKERS_TOPIC];

/// Length of the tip's trail, ns, and time between two messages with it.
const TRAIL_NS: u64 = 10_000_000_000;
const TRAIL_PERIOD_NS: u64 = 2_000_000_000;
/// Color of the setpoints, and of text.
const SETPOINT: [f32; 4] = [0.90, 0.62, 0.0, 1.0];
const TEXT: [f32; 4] = [0.5, 0.5, 0.5, 1.0];
/// Width of the line of the setpoints and height of letters, over the radius of the limb.
const LINE_WIDTH: f64 = 0.15;
const TEXT_HEIGHT: f64 = 0.6;

/// Quality of service of a topic whose last message every later reader needs, as `ros2 bag play` offers it.
const LATCHED: &str = "- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false";

/// A message: number of its topic, content.
type Message = (u16, Vec<u8>);

/// The frames that do not move.
fn standing(info: &RunInfo, limb: &DrawnLimb) -> Vec<(String, Pose)> {
    let solids = info.solids.iter().filter_map(|solid| Some((solid_frame(solid), solid_pose(solid)?)));
    [(BASE.to_owned(), limb.base)].into_iter().chain(solids).collect()
}

/// The limb of a run as viewers load it: its description as URDF, and the frames that do not move. `None` for a log of earlier builds.
pub fn description(info: &RunInfo) -> Option<(String, Vec<(String, Pose)>)> {
    let limb = info.limb.as_ref()?;
    Some((urdf(info, limb), standing(info, limb)))
}

/// Writer of what viewers draw.
#[derive(Debug)]
pub(super) struct Viewer {
    description: u16,
    stays: u16,
    moves: u16,
    tip: u16,
    plan: u16,
    trail: u16,
    markers: u16,
    modules: Vec<String>,
    radius_m: f64,
    /// Where each carried object is, by name, as far as that is known.
    objects: BTreeMap<String, [f64; 3]>,
    /// Times, ns since 1970, and positions of the tip, m.
    places: VecDeque<(u64, [f64; 3])>,
    trail_at: Option<u64>,
    /// Distance of the tip from its setpoint, m.
    error_m: Option<f64>,
    nearest: Option<(f64, String)>,
    /// When the tip last lost what it carried, s after the start of the run.
    lost_s: Option<f64>,
}

impl Viewer {
    /// Declares the topics.
    pub(super) fn declare<W: std::io::Write + std::io::Seek>(
        mcap: &mut mcap::Writer<W>,
        info: &RunInfo,
        limb: &DrawnLimb,
    ) -> mcap::McapResult<Self> {
        let mut declare = |topic: &str, message: MessageType| {
            let schema = mcap.add_schema(message.name, "ros2msg", message.schema().as_bytes())?;
            let latched = [DESCRIPTION_TOPIC, STATIC_TOPIC, PLAN_TOPIC].contains(&topic);
            let quality = latched.then(|| ("offered_qos_profiles".to_owned(), LATCHED.to_owned()));
            mcap.add_channel(schema, topic, "cdr", &quality.into_iter().collect())
        };
        let objects = info.carried.iter().rev().filter_map(|object| Some((object.name.clone(), object.start_m?)));
        Ok(Self {
            description: declare(DESCRIPTION_TOPIC, STRING)?,
            stays: declare(STATIC_TOPIC, TF_MESSAGE)?,
            moves: declare(MOVING_TOPIC, TF_MESSAGE)?,
            tip: declare(TIP_TOPIC, POSE_STAMPED)?,
            plan: declare(PLAN_TOPIC, PATH)?,
            trail: declare(TRAIL_TOPIC, PATH)?,
            markers: declare(MARKERS_TOPIC, MARKER_ARRAY)?,
            modules: limb.modules.clone(),
            radius_m: limb.links.first().map_or(0.0, |link| link.radius_m),
            // Of two phases that take the same object the first counts.
            objects: objects.collect(),
            places: VecDeque::new(),
            trail_at: None,
            error_m: None,
            nearest: None,
            lost_s: None,
        })
    }

    /// What is there all the time: the description, and the frames that do not move.
    pub(super) fn opening(&self, at: u64, info: &RunInfo, limb: &DrawnLimb) -> [Message; 2] {
        [
            (self.description, encode_string(&urdf(info, limb))),
            // Viewers ignore the fixed joints of a description that comes as a message.
            (self.stays, encode_transforms(at, &standing(info, limb))),
        ]
    }

    /// The way that the plan has for the tip: times, ns since 1970, and positions, m.
    pub(super) fn plan(&self, at: u64, places: &[(u64, [f64; 3])]) -> Message {
        (self.plan, encode_path(at, places.iter().copied()))
    }

    /// Takes the error of the tip, for the text.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let seen = sample.tip_achieved_m.unwrap_or(sample.tip_modelled_m);
        let error_m = frames::difference(seen, sample.tip_setpoint_m).norm();
        self.error_m = error_m.is_finite().then_some(error_m);
    }

    /// Takes the clearance, for the text.
    pub(super) fn body(&mut self, body: &Body) {
        self.nearest.clone_from(&body.nearest);
    }

    /// Takes a fault: what the tip loses stays where it was lost.
    pub(super) fn fault(&mut self, fault: &FaultRecord) {
        if [FaultRecord::DROPPED, FaultRecord::LEFT_BEHIND].contains(&fault.code) {
            self.lost_s = Some(fault.time_s);
        }
    }

    /// The limb and what it carries, and every two seconds the trail of the tip.
    pub(super) fn posture(&mut self, at: u64, info: &RunInfo, posture: &Posture) -> Vec<Message> {
        let tip_m = posture.tip.position_m;
        for object in &info.carried {
            let is_lost = self.lost_s.is_some_and(|lost_s| lost_s >= object.from_s);
            let is_due = posture.time_s >= object.from_s && object.to_s.is_none_or(|to_s| posture.time_s <= to_s);
            if is_due && !is_lost {
                self.objects.insert(object.name.clone(), tip_m);
            }
        }
        let objects = self.objects.iter().map(|(name, place)| (carried_frame(name), Pose::upright(*place)));
        let frames: Vec<_> = posture.frames(&self.modules).chain(objects).collect();
        let mut messages =
            vec![(self.moves, encode_transforms(at, &frames)), (self.tip, encode_pose(at, &posture.tip))];
        self.places.push_back((at, tip_m));
        while self.places.front().is_some_and(|(then, _)| then + TRAIL_NS < at) {
            self.places.pop_front();
        }
        // A clock that went back starts again.
        if self.trail_at.is_none_or(|last| at < last || at - last >= TRAIL_PERIOD_NS) {
            self.trail_at = Some(at);
            messages.push((self.trail, encode_path(at, self.places.iter().copied())));
        }
        messages
    }

    /// The line of the setpoints, and the error of the tip and the clearance as text.
    pub(super) fn shape(&self, at: u64, shape: &Shape) -> Message {
        let mut text = String::new();
        if let Some(error_m) = self.error_m {
            let _ = write!(text, "tip error {:.1} mm", 1e3 * error_m);
        }
        if let Some((distance_m, name)) = &self.nearest {
            let _ = write!(text, "\nclearance {:.1} mm ({name})", 1e3 * distance_m);
        }
        let line = Marker {
            namespace: "setpoint",
            kind: Kind::Line(&shape.setpoint),
            color: SETPOINT,
            size_m: LINE_WIDTH * self.radius_m,
        };
        let mut markers = vec![line];
        if let Some([x, y, z]) = shape.setpoint.last().filter(|_| !text.is_empty()) {
            let above_m = [*x, *y, z + 2.0 * self.radius_m];
            let (kind, size_m) = (Kind::Text(above_m, &text), TEXT_HEIGHT * self.radius_m);
            markers.push(Marker { namespace: "text", kind, color: TEXT, size_m });
        }
        (self.markers, encode_markers(at, &markers))
    }
}
