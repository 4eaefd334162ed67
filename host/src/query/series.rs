//! One question about segments in series, as a line of JSON, and its answer.

use fra_model::{
    Actuator, ActuatorParameters, Fiber, InvalidParameter, InvalidSeries, Load, Motion, Precision, PressureRange, Real,
    Series, SeriesSolution, SeriesTarget, Solution, State, Status,
};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use softlimb_fea::cross_section::is_wound_bender;

use super::batch::{Answer, Scalar, Solver, answered, as_written, beyond_the_test, word};
use super::convert;
use super::errors::Errors;
use super::request::{
    Case, Fibers, MaterialSpec, Model, MotionName, Problem, Question, load, material, only, present, tolerance,
};
use super::two_windings;
use softlimb_files::object::{NamedOr, Object};

/// Steps of the search for a pressure.
const STEPS: usize = 30;
/// Relative tolerance of that search: far below the error of discretisation.
const TOLERANCE: f64 = 1e-11;
/// Smaller targets are compared with this, rad or lengths of the series.
const LEAST: f64 = 1e-3;

/// A line of a batch that asks about a series, as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SeriesRequest {
    /// Copied to the answer.
    #[serde(default)]
    pub(super) id: Value,
    #[serde(default)]
    model: Model,
    tolerance: Option<f64>,
    errors: Option<bool>,
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
    fiber: Option<Fibers>,
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
    parts: Vec<Part>,
    question: Question<SeriesTarget<f64>>,
    load: Load<f64>,
    model: Model,
    tolerance: f64,
    errors: Option<bool>,
}

/// A segment in the terms of the model.
struct Part {
    parameters: ActuatorParameters<f64>,
    second_fiber: Option<Fiber<f64>>,
    /// Largest stretch of the test behind the law of a named elastomer.
    stretch_max: Option<f64>,
    /// Direction it bends towards, rad.
    direction_rad: f64,
}

/// One segment of an answer.
#[derive(Serialize)]
struct SegmentAnswer {
    axial_stretch: f64,
    inner_radius_m: f64,
    outer_radius_m: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<Errors>,
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
    #[serde(skip_serializing_if = "Option::is_none")]
    residual: Option<f64>,
    iterations: u32,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
}

impl SeriesRequest {
    /// The case, or what the request leaves out or has too much of. Values are the model's to check.
    pub(super) fn case(&self) -> Result<SeriesCase, String> {
        let segments = self.segments.iter().enumerate();
        let segments = segments.map(|(index, spec)| spec.0.segment().map_err(|message| in_segment(index, message)));
        Ok(SeriesCase {
            parts: segments.collect::<Result<_, _>>()?,
            question: self.problem.question(self.pressure_pa, self.target.as_ref(), SeriesTargetSpec::target)?,
            load: load(self.external_force_n, self.external_torque_nm),
            model: self.model,
            tolerance: tolerance(self.tolerance, self.model)?,
            errors: self.errors,
        })
    }
}

fn in_segment(index: usize, message: impl std::fmt::Display) -> String {
    format!("segment {index}: {message}")
}

impl SegmentSpec {
    fn segment(&self) -> Result<Part, String> {
        let motion = self.motion.motion();
        let direction_deg = self.bend_direction_deg.unwrap_or(0.0);
        if !direction_deg.is_finite() {
            return Err(format!("bend_direction_deg = {direction_deg} is not allowed: finite"));
        }
        let (material, stretch_max) = material(&self.material)?;
        let [fiber, second_fiber] = match &self.fiber {
            None => [None, None],
            Some(fibers) => fibers.windings(motion, self.outer_radius_m)?,
        };
        let parameters = ActuatorParameters {
            motion,
            inner_radius_m: self.inner_radius_m,
            outer_radius_m: self.outer_radius_m,
            length_m: self.length_m,
            material,
            fiber,
        };
        Ok(Part { parameters, second_fiber, stretch_max, direction_rad: direction_deg.to_radians() })
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

impl Part {
    fn bends(&self) -> bool {
        self.parameters.motion == Motion::Bending
    }

    /// The forward question about it at a pressure, Pa.
    fn case(&self, of: &SeriesCase, pressure_pa: f64, (model, errors): (Model, Option<bool>)) -> Case {
        Case {
            model,
            parameters: self.parameters,
            second_fiber: self.second_fiber,
            stretch_max: self.stretch_max,
            question: Question::Forward { pressure_pa },
            range: PressureRange::physical(),
            all: false,
            load: of.load,
            tolerance: of.tolerance,
            errors: errors == Some(true),
            winding: errors != Some(false),
        }
    }
}

/// The outcome of a search for a pressure: the pressure, Pa, or why there is none.
type Found = Result<f64, Status>;

impl SeriesCase {
    /// Computed in a scalar; or what the model does not accept, in words.
    pub(super) fn answer(&self, id: Value, solver: &mut Solver) -> Result<SeriesAnswer, String> {
        let scalar = solver.scalar;
        // Checked first in the precision and unit it is written in, so that a message quotes the value as written.
        let written = self.actuators(|p| *p, convert::fiber, |error| error)?;
        let series = Series::new(&written).map_err(|error| error.to_string())?;
        if self.is_by_parts()? {
            return self.by_parts(id, &series, solver);
        }
        if scalar == Scalar::F64 {
            return self.solve(id, &series);
        }
        let rounded = self.actuators::<f32>(convert::parameters, convert::fiber, convert::invalid)?;
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
        let directions = self.parts.iter().map(|part| nalgebra::convert(part.direction_rad));
        let tip = series.tip_pose(&Isometry3::identity(), states.iter().copied().zip(directions));
        let mut answer = SeriesAnswer::of(id, &solution, &states, &tip);
        if solution.status == Status::Solved {
            let stretched = self.parts.iter().zip(states.iter().map(convert::state)).enumerate();
            let warnings = stretched.filter_map(|(index, (part, state))| {
                let warning = beyond_the_test(&part.parameters, part.stretch_max, &state)?;
                Some(in_segment(index, warning))
            });
            answer.warnings = warnings.collect();
        }
        Ok(answer)
    }

    /// Whether each segment is a question about an actuator, with its model and errors; else the series is one of analytic actuators.
    fn is_by_parts(&self) -> Result<bool, String> {
        for (index, part) in self.parts.iter().enumerate() {
            if part.second_fiber.is_some() {
                let case = part.case(self, 0.0, (self.model, Some(false)));
                two_windings::is_by_section(&case).map_err(|message| in_segment(index, message))?;
            }
        }
        let wound = || self.parts.iter().any(|part| is_wound_bender(&part.parameters));
        let has_choice = self.model != Model::Analytic || self.errors != Some(false);
        let by_section = self.model == Model::SectionFe && self.parts.iter().any(Part::bends);
        Ok(self.errors == Some(true) || by_section || (has_choice && wound()))
    }

    /// Answer summed over the segments, each solved with its chosen model.
    fn by_parts(&self, id: Value, series: &Series<'_, f64>, solver: &mut Solver) -> Result<SeriesAnswer, String> {
        // Of bending actuators with two windings it has the first alone, near which the answer lies.
        let analytic = match self.question {
            Question::Forward { pressure_pa } => series.forward(pressure_pa, &self.load),
            Question::Inverse { target } => series.inverse(target, &self.load),
        };
        let analytic = analytic.map_err(|error| error.to_string())?;
        let nothing = |status| SeriesAnswer {
            status: word(status),
            ..SeriesAnswer::of(
                id.clone(),
                &SeriesSolution { status: Status::NoSolution, ..analytic },
                &[],
                &Isometry3::identity(),
            )
        };
        let mut models = vec![self.model; self.parts.len()];
        let pressure_pa = match self.question {
            Question::Forward { pressure_pa } => pressure_pa,
            Question::Inverse { .. } if analytic.status != Status::Solved => return Ok(nothing(analytic.status)),
            Question::Inverse { target } => {
                // In double precision: single steps are too coarse to converge.
                match self.reach(target, analytic.state.pressure_pa, &mut models, &mut Solver::new(Scalar::F64))? {
                    Ok(pressure_pa) => pressure_pa,
                    Err(status) => {
                        return Ok(SeriesAnswer { limit_pressure_pa: None, limit_segment: None, ..nothing(status) });
                    }
                }
            }
        };
        let answers = self.at(pressure_pa, &models, self.errors, solver)?;
        let directions = self.parts.iter().map(|part| part.direction_rad);
        let states: Option<Vec<State<f64>>> = answers.iter().map(|answer| answer.state).collect();
        let tip = series.tip_pose(&Isometry3::identity(), states.iter().flatten().copied().zip(directions));
        Ok(self.summed(id, pressure_pa, &answers, &tip))
    }

    /// The answers of the segments at a pressure, each by a model.
    fn at(
        &self,
        pressure_pa: f64,
        models: &[Model],
        errors: Option<bool>,
        solver: &mut Solver,
    ) -> Result<Vec<Answer>, String> {
        let mut answer = |(index, (part, model)): (usize, (&Part, &Model))| {
            let case = part.case(self, pressure_pa, (*model, errors));
            let mut answer = answered(&case, solver).map_err(|message| in_segment(index, message))?;
            if *model == Model::SectionFe && is_wound_bender(&part.parameters) {
                answer.model = Some("section-fe");
            }
            Ok(answer)
        };
        self.parts.iter().zip(models).enumerate().map(&mut answer).collect()
    }

    /// The pressure of a target, from one near it. Models that are chosen stay for the whole search, and are those of the answer.
    fn reach(
        &self,
        target: SeriesTarget<f64>,
        start_pa: f64,
        models: &mut [Model],
        solver: &mut Solver,
    ) -> Result<Found, String> {
        let mut pressure_pa = start_pa;
        // Each further search has one segment more by finite elements.
        for _ in 0..=self.parts.len() {
            let chosen = self.at(pressure_pa, &vec![self.model; self.parts.len()], Some(false), solver)?;
            let mut is_new = false;
            for (model, answer) in models.iter_mut().zip(&chosen) {
                let name = if answer.model == Some("section-fe") { Model::SectionFe } else { Model::Analytic };
                if self.model == Model::Auto && *model != Model::SectionFe && *model != name {
                    (*model, is_new) = (name, true);
                }
            }
            if !is_new && pressure_pa != start_pa {
                break;
            }
            let length_m: f64 = self.parts.iter().map(|part| part.parameters.length_m).sum();
            let (value, least) = match target {
                SeriesTarget::Extension(value) => (value, LEAST * length_m),
                SeriesTarget::Twist(value) | SeriesTarget::BendAngle(value) => (value, LEAST),
            };
            let miss = |pressure_pa: f64| {
                let answers = self.at(pressure_pa, models, Some(false), solver)?;
                let totals = self.totals(&answers);
                Ok(totals.map(|totals| match target {
                    SeriesTarget::Extension(value) => totals.extension_m - value,
                    SeriesTarget::Twist(value) => totals.twist_rad - value,
                    SeriesTarget::BendAngle(value) => totals.bend_angle_rad - value,
                }))
            };
            match root(pressure_pa, TOLERANCE * value.abs().max(least), miss)? {
                Ok(found_pa) => pressure_pa = found_pa,
                Err(status) => return Ok(Err(status)),
            }
            if pressure_pa == start_pa {
                break;
            }
        }
        Ok(Ok(pressure_pa))
    }

    /// The sums over the segments; `None` where one of them has no equilibrium.
    fn totals(&self, answers: &[Answer]) -> Option<Totals> {
        let mut totals = Totals::default();
        for (part, answer) in self.parts.iter().zip(answers) {
            let state = answer.state.as_ref()?;
            totals.length_m += part.parameters.length_m * (1.0 + state.axial_strain);
            totals.extension_m += part.parameters.length_m * state.axial_strain;
            totals.twist_rad += state.twist_rad;
            totals.bend_angle_rad += state.bend_angle_rad;
            totals.volume_m3 += state.volume_m3;
        }
        Some(totals)
    }

    fn summed(&self, id: Value, pressure_pa: f64, answers: &[Answer], tip: &Isometry3<f64>) -> SeriesAnswer {
        let totals = self.totals(answers);
        let sum = |of: fn(&Totals) -> f64| totals.as_ref().map(of);
        let (place, turn) = (tip.translation.vector, tip.rotation.quaternion());
        let failed = answers.iter().find(|answer| answer.status != "ok");
        let limits = answers.iter().map(|answer| answer.limit_pressure_pa).enumerate();
        let limits = limits.filter_map(|(segment, limit_pa)| Some((segment, limit_pa?)));
        let limit = limits.reduce(|a, b| if b.1 < a.1 { b } else { a }).filter(|_| failed.is_some());
        let segment = |answer: &Answer| {
            Some(SegmentAnswer {
                model: answer.model,
                errors: answer.errors,
                ..SegmentAnswer::of(answer.state.as_ref()?)
            })
        };
        let warnings = answers.iter().zip(&self.parts).enumerate().filter_map(|(index, (answer, part))| {
            let warning = beyond_the_test(&part.parameters, part.stretch_max, answer.state.as_ref()?)?;
            Some(in_segment(index, warning))
        });
        SeriesAnswer {
            id,
            status: failed.map_or("ok", |answer| answer.status),
            pressure_pa: sum(|_| 0.0).map(|_| pressure_pa),
            length_m: sum(|totals| totals.length_m),
            extension_m: sum(|totals| totals.extension_m),
            twist_rad: sum(|totals| totals.twist_rad),
            bend_angle_rad: sum(|totals| totals.bend_angle_rad),
            volume_m3: sum(|totals| totals.volume_m3),
            tip_position_m: totals.as_ref().map(|_| [place.x, place.y, place.z]),
            tip_quaternion_wxyz: totals.as_ref().map(|_| [turn.w, turn.i, turn.j, turn.k]),
            segments: totals.as_ref().map_or_else(Vec::new, |_| answers.iter().filter_map(segment).collect()),
            limit_pressure_pa: limit.map(|(_, limit_pa)| limit_pa),
            limit_segment: limit.map(|(segment, _)| segment),
            residual: answers.iter().map(|answer| answer.residual).reduce(|a, b| Some(a?.max(b?))).flatten(),
            iterations: answers.iter().map(|answer| answer.iterations).sum(),
            warnings: if totals.is_some() { warnings.collect() } else { Vec::new() },
        }
    }

    fn actuators<T: Precision>(
        &self,
        scalar: impl Fn(&ActuatorParameters<f64>) -> ActuatorParameters<T>,
        fiber: impl Fn(&Fiber<f64>) -> Fiber<T>,
        error: impl Fn(InvalidParameter<T>) -> InvalidParameter<f64>,
    ) -> Result<Vec<Actuator<T>>, String> {
        let built = self.parts.iter().enumerate().map(|(index, part)| {
            let parameters = scalar(&part.parameters);
            match part.second_fiber.as_ref().filter(|_| !part.bends()) {
                None => Actuator::new(&parameters).map_err(|invalid| in_segment(index, as_written(error(invalid)))),
                Some(second) => two_windings::wound(&parameters, &fiber(second))
                    .map_err(|invalid| in_segment(index, two_windings::in_winding(error(invalid)))),
            }
        });
        built.collect()
    }
}

/// Sums over the segments.
#[derive(Default)]
struct Totals {
    length_m: f64,
    extension_m: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
    volume_m3: f64,
}

/// The pressure at which a miss vanishes, by the secant method from one near it, below pressures that have no equilibrium.
fn root(
    start_pa: f64,
    tolerance: f64,
    mut miss: impl FnMut(f64) -> Result<Option<f64>, String>,
) -> Result<Found, String> {
    let Some(at_rest) = miss(0.0)? else { return Ok(Err(Status::NoSolution)) };
    if at_rest.abs() <= tolerance {
        return Ok(Ok(0.0));
    }
    let (mut before, mut pressure_pa, mut end_pa) = ((0.0, at_rest), start_pa, f64::INFINITY);
    for _ in 0..STEPS {
        let Some(here) = miss(pressure_pa)? else {
            end_pa = pressure_pa;
            pressure_pa = 0.5 * (before.0 + pressure_pa);
            continue;
        };
        if here.abs() <= tolerance {
            return Ok(Ok(pressure_pa));
        }
        let next_pa = pressure_pa - here * (pressure_pa - before.0) / (here - before.1);
        match next_pa {
            _ if !next_pa.is_finite() => return Ok(Err(Status::NotConverged)),
            _ if next_pa < 0.0 => return Ok(Err(Status::NoSolution)),
            _ => {}
        }
        before = (pressure_pa, here);
        pressure_pa = if next_pa < end_pa { next_pa } else { 0.5 * (pressure_pa + end_pa) };
    }
    Ok(Err(if end_pa.is_finite() { Status::NoSolution } else { Status::NotConverged }))
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
            residual: Some(convert::wide(solution.residual)),
            iterations: solution.iterations,
            warnings: Vec::new(),
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
            model: None,
            errors: None,
        }
    }
}
