//! One question about segments in series, as a line of JSON, and its answer.

use fra_model::{
    Actuator, ActuatorParameters, InvalidParameter, InvalidSeries, Load, Precision, Real, Series, SeriesSolution,
    SeriesTarget, Solution, State, Status,
};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::batch::{Scalar, as_written, word};
use super::convert;
use super::request::{FiberSpec, MaterialSpec, MotionName, Problem, Question, load, material, only, present};
use softlimb_files::object::{NamedOr, Object};

/// A line of a batch that asks about a series, as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SeriesRequest {
    /// Copied to the answer.
    #[serde(default)]
    pub(super) id: Value,
    problem: Problem,
    segments: Vec<Object<SegmentSpec>>,
    pressure_pa: Option<f64>,
    target: Option<Object<SeriesTargetSpec>>,
    external_force_n: Option<f64>,
    external_torque_nm: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentSpec {
    motion: MotionName,
    inner_radius_m: f64,
    outer_radius_m: f64,
    length_m: f64,
    material: NamedOr<MaterialSpec>,
    fiber: Option<Object<FiberSpec>>,
    bend_direction_deg: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SeriesTargetSpec {
    #[serde(default, deserialize_with = "present")]
    extension_m: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    twist_rad: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    bend_angle_rad: Option<f64>,
}

/// A request in the terms of the model.
pub(super) struct SeriesCase {
    /// Each segment with the direction it bends towards, rad.
    segments: Vec<(ActuatorParameters<f64>, f64)>,
    question: Question<SeriesTarget<f64>>,
    load: Load<f64>,
}

/// One segment of an answer.
#[derive(Serialize)]
struct SegmentAnswer {
    axial_stretch: f64,
    inner_radius_m: f64,
    outer_radius_m: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
}

/// A line of output about a series.
#[derive(Serialize)]
pub(super) struct SeriesAnswer {
    id: Value,
    status: &'static str,
    pressure_pa: Option<f64>,
    length_m: Option<f64>,
    extension_m: Option<f64>,
    twist_rad: Option<f64>,
    bend_angle_rad: Option<f64>,
    volume_m3: Option<f64>,
    tip_position_m: Option<[f64; 3]>,
    tip_quaternion_wxyz: Option<[f64; 4]>,
    segments: Vec<SegmentAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_pressure_pa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_segment: Option<usize>,
    residual: f64,
    iterations: u32,
}

impl SeriesRequest {
    /// The case, or what the request leaves out or has too much of. Values are the model's to check.
    pub(super) fn case(&self) -> Result<SeriesCase, String> {
        let segments = self.segments.iter().enumerate();
        let segments = segments.map(|(index, spec)| spec.0.segment().map_err(|message| in_segment(index, message)));
        Ok(SeriesCase {
            segments: segments.collect::<Result<_, _>>()?,
            question: self.problem.question(self.pressure_pa, self.target.as_ref(), SeriesTargetSpec::target)?,
            load: load(self.external_force_n, self.external_torque_nm),
        })
    }
}

fn in_segment(index: usize, message: impl std::fmt::Display) -> String {
    format!("segment {index}: {message}")
}

impl SegmentSpec {
    fn segment(&self) -> Result<(ActuatorParameters<f64>, f64), String> {
        let motion = self.motion.motion();
        let direction_deg = self.bend_direction_deg.unwrap_or(0.0);
        if !direction_deg.is_finite() {
            return Err(format!("bend_direction_deg = {direction_deg} is not allowed: finite"));
        }
        let parameters = ActuatorParameters {
            motion,
            inner_radius_m: self.inner_radius_m,
            outer_radius_m: self.outer_radius_m,
            length_m: self.length_m,
            material: material(&self.material)?.0,
            fiber: self.fiber.as_ref().map(|fiber| fiber.0.fiber(motion, self.outer_radius_m)).transpose()?,
        };
        Ok((parameters, direction_deg.to_radians()))
    }
}

impl SeriesTargetSpec {
    fn target(&self) -> Result<SeriesTarget<f64>, String> {
        only([
            self.extension_m.map(SeriesTarget::Extension),
            self.twist_rad.map(SeriesTarget::Twist),
            self.bend_angle_rad.map(SeriesTarget::BendAngle),
        ])
    }
}

impl SeriesCase {
    /// Computed in a scalar; or what the model does not accept, in words.
    pub(super) fn answer(&self, id: Value, scalar: Scalar) -> Result<SeriesAnswer, String> {
        // Checked first in the precision and unit it is written in, so that a message quotes the value as written.
        let written = self.actuators(|p| *p, as_written)?;
        let series = Series::new(&written).map_err(|error| error.to_string())?;
        if scalar == Scalar::F64 {
            return self.solve(id, &series);
        }
        let rounded = self.actuators::<f32>(convert::parameters, convert::invalid)?;
        self.solve(id, &Series::new(&rounded).map_err(wide)?)
    }

    fn solve<T: Precision>(&self, id: Value, series: &Series<'_, T>) -> Result<SeriesAnswer, String> {
        let load: Load<T> = convert::load(&self.load);
        let mut states = vec![];
        let each = |_: usize, solution: &Solution<T>| states.push(solution.state);
        let solved = match self.question {
            Question::Forward { pressure_pa } => series.forward_each(nalgebra::convert(pressure_pa), &load, each),
            Question::Inverse { target } => series.inverse_each(convert::series_target(target), &load, each),
        };
        let solution = solved.map_err(|error| convert::invalid(error).to_string())?;
        let directions = self.segments.iter().map(|(_, direction)| nalgebra::convert(*direction));
        let tip = series.tip_pose(&Isometry3::identity(), states.iter().copied().zip(directions));
        Ok(SeriesAnswer::of(id, &solution, &states, &tip))
    }

    fn actuators<T: Precision>(
        &self,
        scalar: impl Fn(&ActuatorParameters<f64>) -> ActuatorParameters<T>,
        error: impl Fn(InvalidParameter<T>) -> InvalidParameter<f64>,
    ) -> Result<Vec<Actuator<T>>, String> {
        let built = self.segments.iter().enumerate().map(|(index, (parameters, _))| {
            Actuator::new(&scalar(parameters)).map_err(|invalid| in_segment(index, error(invalid)))
        });
        built.collect()
    }
}

fn wide<T: Real>(error: InvalidSeries<T>) -> String {
    match error {
        InvalidSeries::Empty => InvalidSeries::<f64>::Empty.to_string(),
        InvalidSeries::Segment { segment, error } => in_segment(segment, convert::invalid(error)),
    }
}

impl SeriesAnswer {
    fn of<T: Real>(id: Value, solution: &SeriesSolution<T>, states: &[State<T>], tip: &Isometry3<T>) -> Self {
        let solved = solution.status == Status::Solved;
        let state = &solution.state;
        let sum = |value: T| solved.then(|| convert::wide(value));
        let (place, turn) = (tip.translation.vector, tip.rotation.quaternion());
        Self {
            id,
            status: word(solution.status),
            pressure_pa: sum(state.pressure_pa),
            length_m: sum(state.length_m),
            extension_m: sum(state.extension_m),
            twist_rad: sum(state.twist_rad),
            bend_angle_rad: sum(state.bend_angle_rad),
            volume_m3: sum(state.volume_m3),
            tip_position_m: solved.then(|| [place.x, place.y, place.z].map(convert::wide)),
            tip_quaternion_wxyz: solved.then(|| [turn.w, turn.i, turn.j, turn.k].map(convert::wide)),
            segments: if solved { states.iter().map(SegmentAnswer::of).collect() } else { vec![] },
            limit_pressure_pa: solution.limit.and_then(|limit| limit.pressure_pa).map(convert::wide),
            limit_segment: solution.limit.map(|limit| limit.segment),
            residual: convert::wide(solution.residual),
            iterations: solution.iterations,
        }
    }
}

impl SegmentAnswer {
    fn of<T: Real>(state: &State<T>) -> Self {
        let state = convert::state(state);
        Self {
            axial_stretch: state.axial_stretch,
            inner_radius_m: state.inner_radius_m,
            outer_radius_m: state.outer_radius_m,
            twist_rad: state.twist_rad,
            bend_angle_rad: state.bend_angle_rad,
        }
    }
}
