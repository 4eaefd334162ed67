//! What a limb shall do and what it may be made of, as plain data.

use fra_model::Motion;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::aim::{DIRECTION_MM, MM};
use super::response::RADIUS;
use crate::actuators::{Bounds, Segment};
use softlimb_files::range::{OutOfRange, positive, require};
use softlimb_scene::collision::Shape;

/// Most modules of a limb whose motions are chosen.
pub const MOST_MODULES: usize = 8;
/// Most modules and segments of a limb that is designed.
pub const MOST_PARTS: usize = 16;
/// Most way-points.
pub const MOST_WAY_POINTS: usize = 100;

/// Where the tip shall be.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// At a point, m.
    Point(Vector3<f64>),
    /// Anywhere in a box.
    Inside {
        /// Its centre, m.
        center_m: Vector3<f64>,
        /// Half of its edges along its own axes, m; >= 0.
        half_m: Vector3<f64>,
        /// From its own axes to the frame of the task.
        rotation: UnitQuaternion<f64>,
    },
}

/// Where the end effector shall point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// Unit vector of its axis.
    pub axis: Vector3<f64>,
    /// Angle that it may be off, rad; `0..=pi`.
    pub tolerance_rad: f64,
}

/// Target deformation of a module, summed over its segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Total {
    /// Index of its space, or of that of its first segment.
    pub first: usize,
    /// Its motion.
    pub motion: Motion,
    /// Length (extension) or outer radius (expansion), m; bend angle or twist, rad.
    pub value: f64,
}

impl Total {
    /// Index of the response field that it sums.
    pub(super) fn field(&self) -> usize {
        match self.motion {
            Motion::Extension => 0,
            Motion::Bending => 1,
            Motion::Twisting => 2,
            Motion::Expansion => RADIUS,
        }
    }

    /// Weight of an error of 1 m or 1 rad, mm.
    pub(super) fn mm(&self) -> f64 {
        match self.motion {
            Motion::Extension | Motion::Expansion => MM,
            Motion::Bending | Motion::Twisting => DIRECTION_MM,
        }
    }
}

/// One way-point: a pose that the limb takes with pressures of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct WayPoint {
    /// Where the tip shall be, if that matters.
    pub aim: Option<Aim>,
    /// Targets of modules, all of the same weight.
    pub totals: Vec<Total>,
    /// Weight of its squared error; > 0.
    pub weight: f64,
    /// Where the end effector shall point, if that matters.
    pub direction: Option<Direction>,
}

impl WayPoint {
    /// A way-point for the tip alone, with the weight 1.
    pub fn at(tip_m: [f64; 3]) -> Self {
        Self { aim: Some(Aim::Point(tip_m.into())), ..Self::with(Vec::new()) }
    }

    /// A way-point with targets of modules, for any place of the tip, with weight 1.
    pub fn with(totals: Vec<Total>) -> Self {
        Self { aim: None, totals, weight: 1.0, direction: None }
    }
}

/// Something in the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its name, for answers.
    pub name: String,
    /// The solid.
    pub shape: Shape,
    /// Distance that every point of the limb's surface keeps from it, m; >= 0.
    pub clearance_m: f64,
}

/// What a limb shall do. Lengths in m, in one fixed frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Where the limb starts: it runs along `z`, and modules with a mount angle of zero bend towards `x`.
    pub base: Isometry3<f64>,
    /// Length and radius of the rigid part behind every module, m; >= 0.
    pub connector_m: [f64; 2],
    /// Length and radius of the end effector, m; >= 0.
    pub tool_m: [f64; 2],
    /// Mass of all rigid parts of a module and of the end effector, kg; >= 0.
    pub rigid_mass_kg: [f64; 2],
    /// The way-points in their order.
    pub way_points: Vec<WayPoint>,
    /// What is in the way.
    pub obstacles: Vec<Obstacle>,
    /// Whether the moves from one way-point to the next keep the clearance too, along the straight line in the modules' deformations.
    pub moves: bool,
    /// Whether there is a move from the limb without pressure to the first way-point.
    pub from_rest: bool,
}

/// What one module, or one segment of its actuator, may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// Motion, material, winding, bounds of the geometry and pressure; its goals are not used.
    pub segment: Segment,
    /// Number of its actuators, 1 to 100.
    pub actuators: u32,
    /// Distance of the farthest actuator from the module's axis, m; >= 0, and 0 for a twisting module: plates hold twisting actuators back that stand
    /// beside the axis.
    pub reach_m: f64,
    /// Lengths at the base and at the tip that caps take out of the motion, m; >= 0. The bounds of the length are those of what moves.
    pub ends_m: [f64; 2],
    /// Whether it continues the actuator of the space before it, as its next segment. Both share radii, pressure and mount angle, with nothing rigid
    /// between them. Their bounds of radii are equal.
    pub joined: bool,
    /// Bounds of the direction that it bends towards, rad about the limb's axis; a width of a full turn or more leaves it free.
    pub mount_angle_rad: Bounds,
    /// Density of the elastomer, kg/m3; > 0.
    pub density_kg_per_m3: f64,
}

impl Space {
    /// The motion.
    pub fn motion(&self) -> Motion {
        self.segment.motion
    }
}

/// Why a design cannot be searched for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TaskError {
    /// A number out of its range.
    #[error("{place}: {error}")]
    Value {
        /// Which part of the task it is in.
        place: String,
        /// The number.
        error: OutOfRange,
    },
    /// Bounds that leave no actuator which the model can solve.
    #[error("{place}: no geometry within the bounds can be solved: {reason}")]
    Bounds {
        /// The module.
        place: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A count that is not accepted.
    #[error("{field}: {found} is not allowed: {allowed}")]
    Count {
        /// What is counted.
        field: &'static str,
        /// How many there are.
        found: usize,
        /// How many there may be.
        allowed: String,
    },
    /// A saved search that belongs to another task.
    #[error("the saved search belongs to another task, other bounds or other options: it cannot be resumed")]
    OtherSearch,
}

fn at<T>(place: impl Fn() -> String, result: Result<T, OutOfRange>) -> Result<T, TaskError> {
    result.map_err(|error| TaskError::Value { place: place(), error })
}

fn non_negative(field: &'static str, value: f64) -> Result<(), OutOfRange> {
    require(value.is_finite() && value >= 0.0, field, value, "finite and >= 0")
}

fn finite(field: &'static str, vector: &Vector3<f64>) -> Result<(), OutOfRange> {
    vector.iter().try_for_each(|value| require(value.is_finite(), field, *value, "finite"))
}

fn ordered(field: &'static str, [low, high]: Bounds, least: f64) -> Result<(), OutOfRange> {
    require(low.is_finite() && low > least, field, low, format!("finite and > {least}"))?;
    require(high.is_finite() && high >= low, field, high, format!("finite and >= the lower bound {low}"))
}

pub(super) fn count(
    field: &'static str,
    found: usize,
    allowed: std::ops::RangeInclusive<usize>,
) -> Result<(), TaskError> {
    let message = || format!("{} to {}", allowed.start(), allowed.end());
    if allowed.contains(&found) { Ok(()) } else { Err(TaskError::Count { field, found, allowed: message() }) }
}

/// The module or segment behind another one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Behind {
    /// Length that its cap takes at the base, m.
    pub(super) end_m: f64,
    /// Whether it is a segment of the same actuator.
    pub(super) joined: bool,
}

impl Task {
    /// Whether the move to a way-point counts.
    pub(super) fn move_to(&self, way_point: usize) -> bool {
        self.moves && (way_point > 0 || self.from_rest)
    }

    /// Where the part of a limb starts that moves, behind a first end, m.
    pub(super) fn start(&self, end_m: f64) -> Isometry3<f64> {
        self.base * Translation3::new(0.0, 0.0, end_m)
    }

    /// Lengths of the rigid parts behind a module with an end of some length, m: the connector between its end and that of the next, if there is
    /// one, and the end effector behind the last; none between segments of one actuator.
    pub(super) fn rigid_parts_m(&self, end_m: f64, next: Option<Behind>) -> [f64; 2] {
        match next {
            Some(Behind { joined: true, .. }) => [0.0; 2],
            Some(next) => [end_m + self.connector_m[0] + next.end_m, 0.0],
            None => [end_m + self.connector_m[0], self.tool_m[0]],
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`TaskError`] with place, field, value and allowed range of the first that is not accepted.
    pub fn check(&self) -> Result<(), TaskError> {
        let task = || "task".to_owned();
        at(task, finite("base position_m", &self.base.translation.vector))?;
        let rigid = [("connector_m", self.connector_m), ("tool_m", self.tool_m), ("rigid_mass_kg", self.rigid_mass_kg)];
        for (field, values) in rigid {
            at(task, values.into_iter().try_for_each(|value| non_negative(field, value)))?;
        }
        count("way_points", self.way_points.len(), 1..=MOST_WAY_POINTS)?;
        for (index, way_point) in self.way_points.iter().enumerate() {
            at(|| format!("way-point {}", index + 1), way_point.check())?;
        }
        self.obstacles.iter().try_for_each(|obstacle| {
            at(|| format!("obstacle {}", obstacle.name), non_negative("clearance_m", obstacle.clearance_m))
        })
    }
}

impl WayPoint {
    fn check(&self) -> Result<(), OutOfRange> {
        positive("weight", self.weight)?;
        match &self.aim {
            None => {}
            Some(Aim::Point(point)) => finite("tip_m", point)?,
            Some(Aim::Inside { center_m, half_m, .. }) => {
                finite("center_m", center_m)?;
                half_m.iter().try_for_each(|half| non_negative("half_m", *half))?;
            }
        }
        self.totals.iter().try_for_each(|total| require(total.value.is_finite(), "total", total.value, "finite"))?;
        let Some(direction) = &self.direction else { return Ok(()) };
        let norm = direction.axis.norm();
        require((norm - 1.0).abs() < 1e-9, "direction norm", norm, "1")?;
        let tolerance = direction.tolerance_rad;
        require((0.0..=std::f64::consts::PI).contains(&tolerance), "tolerance_rad", tolerance, "0 to pi")
    }
}

impl Space {
    /// Its end and joint to the module before it.
    pub(super) fn behind(&self) -> Behind {
        Behind { end_m: self.ends_m[0], joined: self.joined }
    }

    /// Requires that a segment continues the actuator of `before`.
    ///
    /// # Errors
    /// [`TaskError::Bounds`] for a segment without one before it, or whose radii, wall or pressure have other bounds.
    pub(super) fn check_joint(&self, before: Option<&Self>) -> Result<(), TaskError> {
        let alike = |before: &Self| {
            let [own, other] = [&self.segment, &before.segment];
            (own.bounds.sizes, own.bounds.sizes_m, own.pressure_max_pa, self.actuators, self.reach_m)
                == (other.bounds.sizes, other.bounds.sizes_m, other.pressure_max_pa, before.actuators, before.reach_m)
        };
        if !self.joined || before.is_some_and(alike) {
            return Ok(());
        }
        let reason = "a segment has the radii, the pressure and the places of the one before it".to_owned();
        Err(TaskError::Bounds { place: format!("module {}", self.segment.name), reason })
    }

    /// Checks every number but those that the model checks when an actuator is built.
    ///
    /// # Errors
    /// [`TaskError`], as [`Task::check`].
    pub fn check(&self) -> Result<(), TaskError> {
        let place = || format!("module {}", self.segment.name);
        let bounds = &self.segment.bounds;
        let sizes = bounds.sizes.names().into_iter().zip(bounds.sizes_m);
        sizes.into_iter().try_for_each(|(name, range)| at(place, ordered(name, range, 0.0)))?;
        at(place, ordered("length_m", bounds.length_m, 0.0))?;
        count("actuators", self.actuators as usize, 1..=100)?;
        at(place, non_negative("reach_m", self.reach_m))?;
        at(place, self.ends_m.into_iter().try_for_each(|end_m| non_negative("ends_m", end_m)))?;
        if self.motion() == Motion::Twisting {
            at(place, require(self.reach_m == 0.0, "reach_m", self.reach_m, "0 for a twisting module"))?;
        }
        if self.motion() != Motion::Bending {
            at(place, ordered("fiber_angle_rad", bounds.angle_rad, -1.571))?;
        }
        at(place, ordered("mount_angle_rad", self.mount_angle_rad, -1e3))?;
        at(place, positive("pressure_max_pa", self.segment.pressure_max_pa))?;
        let margin = self.segment.limit_margin;
        at(place, require((0.001..=0.9).contains(&margin), "limit_margin", margin, "0.001 to 0.9"))?;
        at(place, positive("density_kg_per_m3", self.density_kg_per_m3))
    }
}
