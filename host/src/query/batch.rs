//! Questions to the actuator model from other programs: a JSON object a line in, one a line out, in order.
//!
//! `docs/reference/eval-batch.md` describes the interface.

use std::io::{self, BufRead, Write};
use std::num::NonZero;
use std::thread;

use fra_model::{
    Actuator, ActuatorParameters, InvalidParameter, Load, Precision, Real, Solution, State, Status, Target,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::chunks;
use super::complaint;
use super::convert;
use super::errors::{self, Errors};
use super::fields;
use super::request::{Case, Model, Question, Request};
use super::section_all::{self, Every};
use super::section_fe::{Discretisation, SectionAnswer, SectionQuery, solve_section};
use super::series::{SeriesAnswer, SeriesRequest};
use super::two_windings;
use softlimb_fea::cross_section::{SectionError, is_wound_bender};
use softlimb_files::object::Object;
use softlimb_limb::largest_stretch;

/// The precision a batch is computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// Double precision, as on the host.
    F64,
    /// Single precision, as on the MCU.
    F32,
}

/// A line of output about one actuator.
pub(super) struct Answer {
    pub(super) status: &'static str,
    /// Of the equilibrium, with the status `ok`.
    pub(super) state: Option<State<f64>>,
    pub(super) limit_pressure_pa: Option<f64>,
    pub(super) residual: Option<f64>,
    pub(super) iterations: u32,
    discretisation_error: Option<Discretisation>,
    all: Option<All>,
    /// The model that answered, where there was a choice.
    pub(super) model: Option<&'static str>,
    pub(super) errors: Option<Errors>,
    warning: Option<String>,
    message: Option<String>,
}

/// Every solution of an inverse question, and whether more of them may be unknown.
struct All {
    solutions: Vec<State<f64>>,
    complete: bool,
}

/// Answers every line of `input` on `output`, in order. Empty lines are passed over.
///
/// All processors compute; the bytes do not depend on their number.
///
/// # Errors
/// Only what reading and writing raise: a line that cannot be answered is answered with its status.
pub fn batch(input: impl BufRead, output: impl Write, scalar: Scalar) -> io::Result<()> {
    let threads = thread::available_parallelism().unwrap_or(NonZero::<usize>::MIN);
    batch_on(threads, input, output, scalar)
}

/// [`batch`] on a number of threads.
///
/// # Errors
/// As [`batch`].
pub fn batch_on(threads: NonZero<usize>, input: impl BufRead, output: impl Write, scalar: Scalar) -> io::Result<()> {
    chunks::in_order(threads, input, output, |chunk| {
        let mut answers = Vec::with_capacity(chunk.lines.len());
        let mut solver = Solver::new(scalar);
        let (mut rest, mut number) = (chunk.lines.as_slice(), chunk.first_line);
        while !rest.is_empty() {
            rest = write_next(rest, number, &mut solver, &mut answers)?;
            number += 1;
        }
        Ok(answers)
    })
}

/// Writes the answer to the first of some lines, and returns the others.
fn write_next<'a>(
    lines: &'a [u8],
    number: usize,
    solver: &mut Solver,
    out: &mut Vec<u8>,
) -> serde_json::Result<&'a [u8]> {
    // Most lines end where their question ends, and are read once.
    if let Some((request, rest)) = fields::read(lines) {
        write_answer(actuator(&request, solver), &request.id, number, out)?;
        return Ok(rest);
    }
    let end = lines.iter().position(|byte| *byte == b'\n');
    let (line, rest) = end.map_or((lines, &[][..]), |end| (&lines[..end], &lines[end + 1..]));
    if line.trim_ascii().is_empty() {
        return Ok(rest);
    }
    match parsed::<Request>(line) {
        Ok(request) => write_answer(actuator(&request, solver), &request.id, number, out)?,
        Err(_) if is_about_a_series(line) => match series(line, solver) {
            Ok(answer) => {
                serde_json::to_writer(&mut *out, &answer)?;
                out.push(b'\n');
            }
            Err((id, message)) => write_answer(Err(message), &id, number, out)?,
        },
        Err((id, message)) => write_answer(Err(message), &id, number, out)?,
    }
    Ok(rest)
}

fn write_answer(
    answer: Result<Answer, String>,
    id: &Value,
    number: usize,
    out: &mut Vec<u8>,
) -> serde_json::Result<()> {
    let invalid = |message| Answer::without_state("invalid", Some(format!("line {number}: {message}")));
    answer.unwrap_or_else(invalid).write(id, out)?;
    out.push(b'\n');
    Ok(())
}

/// An answer, or the `id` and what is wrong.
type Answered<T> = Result<T, (Value, String)>;

/// Whether a line that is no question about one actuator is one about a series: because of its field `segments`.
fn is_about_a_series(line: &[u8]) -> bool {
    const FIELD: &[u8] = b"\"segments\"";
    // Most lines do not hold the word, and need not be read twice.
    line.windows(FIELD.len()).any(|part| part == FIELD)
        && serde_json::from_slice::<Value>(line).is_ok_and(|value| value.get("segments").is_some())
}

pub(super) fn parsed<T: DeserializeOwned>(line: &[u8]) -> Answered<T> {
    let Object(request) = serde_json::from_slice(line).map_err(|error| (id_of(line), complaint::plain(&error)))?;
    Ok(request)
}

fn actuator(request: &Request, solver: &mut Solver) -> Result<Answer, String> {
    let case = request.case()?;
    let mut answer = answered(&case, solver)?;
    answer.warning = answer.state.as_ref().and_then(|state| beyond_the_test(&case.parameters, case.stretch_max, state));
    Ok(answer)
}

pub(super) fn answered(case: &Case, solver: &mut Solver) -> Result<Answer, String> {
    let is_by_section = match case.second_fiber {
        None => case.model == Model::SectionFe,
        Some(_) => two_windings::is_by_section(case)?,
    };
    match (&case.question, is_by_section) {
        (Question::Inverse { target }, true) if case.all => every_by_section(case, *target),
        (Question::Inverse { target }, false) if case.all => every_solution(case, *target, solver.scalar),
        (_, true) => Ok(of_section(case, &by_section(case)?)),
        (_, false) => {
            let solution = match (&case.second_fiber, solver.scalar) {
                (Some(second), scalar) => two_windings::answer(case, second, scalar)?,
                (None, Scalar::F64) => solver.solve_double(case)?,
                (None, Scalar::F32) => solver.solve_single(case)?,
            };
            if !serves(case, &solution)
                && let Ok(found) = by_section(case)
            {
                return Ok(of_section(case, &found));
            }
            Ok(of_analytic(case, &solution, solver.scalar))
        }
    }
}

/// Whether the analytic answer stands: with model `auto` where its error is within the tolerance, or finite elements have no answer.
fn serves(case: &Case, analytic: &Solution<f64>) -> bool {
    // Most answers are not about a wound bender.
    if case.model == Model::Analytic || !is_wound_bender(&case.parameters) {
        return true;
    }
    let is_within = || errors::estimated(case, &analytic.state).is_some_and(|error| error <= case.tolerance);
    analytic.status == Status::Solved && (analytic.state.pressure_pa < 0.0 || is_within())
}

/// Whether an answer has its model and errors.
fn has_errors(case: &Case) -> bool {
    case.errors || ((case.winding || case.model == Model::Auto) && is_wound_bender(&case.parameters))
}

/// The analytic answer, of a wound bender with its errors.
fn of_analytic(case: &Case, solution: &Solution<f64>, scalar: Scalar) -> Answer {
    if !has_errors(case) {
        return Answer::of(solution);
    }
    let is_solved = solution.status == Status::Solved;
    let errors = is_solved.then(|| errors::of_analytic(case, &solution.state, precision(scalar)));
    Answer { model: Some("analytic"), errors, ..Answer::of(solution) }
}

/// The answer of finite elements, of a wound bender with its errors.
fn of_section(case: &Case, found: &SectionAnswer) -> Answer {
    let answer = Answer::found(found);
    if !(has_errors(case) || case.model == Model::Auto) {
        return answer;
    }
    let discretisation = found.error.map(|error| error.natural(case.parameters.motion));
    let errors = found.state.as_ref().map(|state| errors::of_section(case, state, discretisation));
    Answer { model: Some("section-fe"), errors, ..answer }
}

fn precision(scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F64 => f64::EPSILON,
        Scalar::F32 => f64::from(f32::EPSILON),
    }
}

/// The answer with every solution in the range, by the model of the first.
fn every_solution(case: &Case, target: Target<f64>, scalar: Scalar) -> Result<Answer, String> {
    let (first, all) = match scalar {
        Scalar::F64 => all::<f64>(case, target, |parameters| *parameters)?,
        Scalar::F32 => all::<f32>(case, target, convert::parameters)?,
    };
    if !serves(case, &first)
        && let Ok(answer) = every_by_section(case, target)
    {
        return Ok(answer);
    }
    Ok(Answer { all: Some(all), ..of_analytic(case, &first, scalar) })
}

/// The answer of finite elements with every solution that they have in the range.
fn every_by_section(case: &Case, target: Target<f64>) -> Result<Answer, String> {
    let Every { first, solutions, complete } =
        with_section(case, |query| section_all::every_by_section(query, target))?;
    let solutions = solutions.iter().filter_map(|one| one.state).collect();
    Ok(Answer { all: Some(All { solutions, complete }), ..of_section(case, &first) })
}

fn all<T: Precision>(
    case: &Case,
    target: Target<f64>,
    rounded: impl Fn(&ActuatorParameters<f64>) -> ActuatorParameters<T>,
) -> Result<(Solution<f64>, All), String> {
    case.parameters.check().map_err(|error| as_written(error).to_string())?;
    let invalid = |error: InvalidParameter<T>| convert::invalid(error).to_string();
    let parameters = rounded(&case.parameters);
    let actuator = match &case.second_fiber {
        None => Actuator::new(&parameters),
        Some(second) => two_windings::wound(&parameters, &convert::fiber(second)),
    };
    let actuator = actuator.map_err(invalid)?;
    let (range, load, target) = (convert::range(&case.range), convert::load(&case.load), convert::target(target));
    let mut solutions = vec![];
    let complete = actuator
        .inverse_all(&range, target, &load, &mut |found| solutions.push(convert::state(&found.state)))
        .map_err(invalid)?;
    let first = convert::solution(&actuator.inverse_within(&range, target, &load).map_err(invalid)?);
    Ok((first, All { solutions, complete }))
}

fn by_section(case: &Case) -> Result<SectionAnswer, String> {
    with_section(case, solve_section)
}

/// The result of a solver for the query of a case, its errors in the units that the request is written in.
fn with_section<T>(case: &Case, solve: impl FnOnce(&SectionQuery<'_>) -> Result<T, SectionError>) -> Result<T, String> {
    // Checked first in the unit it is written in, as for the other model.
    let invalid = |error| match case.second_fiber {
        None => as_written(error).to_string(),
        Some(_) => two_windings::in_winding(error),
    };
    case.parameters.check().map_err(invalid)?;
    let Case { parameters, question, range, load, .. } = case;
    let second_fiber = case.second_fiber.as_ref();
    let query = SectionQuery { parameters, second_fiber, question: *question, range: *range, load: *load };
    solve(&query).map_err(|error| match (error, second_fiber) {
        (SectionError::SecondWinding(error), _) => two_windings::of_winding("second", error),
        (error, _) => error.to_string(),
    })
}

fn series(line: &[u8], solver: &mut Solver) -> Answered<SeriesAnswer> {
    let request: SeriesRequest = parsed(line)?;
    let answered = request.case().and_then(|case| case.answer(request.id.clone(), solver));
    answered.map_err(|message| (request.id, message))
}

/// The `id` of a line that is JSON but no request, so that its answer can be told from others.
fn id_of(line: &[u8]) -> Value {
    let parsed = serde_json::from_slice::<Value>(line).ok();
    parsed.and_then(|value| value.get("id").cloned()).unwrap_or(Value::Null)
}

/// Solves questions one after the other. It keeps the last actuator: batches often ask for many pressures of the same one.
pub(super) struct Solver {
    pub(super) scalar: Scalar,
    double: Last<f64>,
    single: Last<f32>,
}

/// The last actuator's parameters, as the bits they were written in, and itself once it was asked for twice: most of a batch of different
/// actuators are not worth a copy.
struct Last<T: Real> {
    bits: Option<ActuatorParameters<u64>>,
    actuator: Option<Actuator<T>>,
}

impl<T: Real> Last<T> {
    fn none() -> Self {
        Self { bits: None, actuator: None }
    }
}

impl Solver {
    pub(super) fn new(scalar: Scalar) -> Self {
        Self { scalar, double: Last::none(), single: Last::none() }
    }

    fn solve_double(&mut self, case: &Case) -> Result<Solution<f64>, String> {
        solved(&mut self.double, case, |parameters| *parameters).map_err(|error| as_written(error).to_string())
    }

    fn solve_single(&mut self, case: &Case) -> Result<Solution<f64>, String> {
        // Checked first in the precision and unit it is written in, so that a message quotes the value as written.
        case.parameters.check().map_err(|error| as_written(error).to_string())?;
        let solution = solved(&mut self.single, case, convert::parameters);
        let solution = solution.map_err(|error| convert::invalid(error).to_string())?;
        Ok(convert::solution(&solution))
    }
}

/// The answer of the last actuator, or of another one that takes its place.
fn solved<T: Precision>(
    last: &mut Last<T>,
    case: &Case,
    rounded: impl Fn(&ActuatorParameters<f64>) -> ActuatorParameters<T>,
) -> Result<Solution<T>, InvalidParameter<T>> {
    // Bits, not numbers: the sign of a zero may show in an answer.
    let bits = Some(case.parameters.map(f64::to_bits));
    if last.bits == bits {
        let actuator = match &mut last.actuator {
            Some(actuator) => actuator,
            none => none.insert(Actuator::new(&rounded(&case.parameters))?),
        };
        return solve(actuator, case);
    }
    (last.bits, last.actuator) = (bits, None);
    let parameters = rounded(&case.parameters);
    match case.question {
        Question::Forward { pressure_pa } => {
            Actuator::forward_once(&parameters, nalgebra::convert(pressure_pa), &convert::load(&case.load))
        }
        // Asked where it was built.
        Question::Inverse { .. } => match &Actuator::new(&parameters) {
            Ok(actuator) => solve(actuator, case),
            Err(error) => Err(*error),
        },
    }
}

fn solve<T: Precision>(actuator: &Actuator<T>, case: &Case) -> Result<Solution<T>, InvalidParameter<T>> {
    let load: Load<T> = convert::load(&case.load);
    match case.question {
        Question::Forward { pressure_pa } => actuator.forward(nalgebra::convert(pressure_pa), &load),
        Question::Inverse { target } => {
            actuator.inverse_within(&convert::range(&case.range), convert::target(target), &load)
        }
    }
}

/// The fiber angle is asked for in degrees.
pub(super) fn as_written(error: InvalidParameter<f64>) -> InvalidParameter<f64> {
    match error.field {
        "angle_rad" => InvalidParameter {
            field: "fiber.angle_deg",
            value: error.value.to_degrees(),
            allowed: "-90 to 90, from the hoop",
        },
        _ => error,
    }
}

/// The warning of a wall that stretches further than the test behind the law of its elastomer.
pub(super) fn beyond_the_test(
    parameters: &ActuatorParameters<f64>,
    stretch_max: Option<f64>,
    state: &State<f64>,
) -> Option<String> {
    let (most, stretch) = (stretch_max?, largest_stretch(parameters, state));
    (stretch > most)
        .then(|| format!("the wall stretches to {stretch:.2}, and the test behind the law ends at {most:.2}"))
}

/// A status in the words of the interface.
pub(super) fn word(status: Status) -> &'static str {
    match status {
        Status::Solved => "ok",
        Status::NoSolution => "no_solution",
        Status::NotConverged => "not_converged",
    }
}

/// One of several solutions.
#[derive(Serialize)]
struct Listed {
    pressure_pa: f64,
    axial_stretch: f64,
    inner_radius_m: f64,
    outer_radius_m: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
}

impl Listed {
    fn of(state: &State<f64>) -> Self {
        Self {
            pressure_pa: state.pressure_pa,
            axial_stretch: state.axial_stretch,
            inner_radius_m: state.inner_radius_m,
            outer_radius_m: state.outer_radius_m,
            twist_rad: state.twist_rad,
            bend_angle_rad: state.bend_angle_rad,
        }
    }
}

impl Answer {
    fn without_state(status: &'static str, message: Option<String>) -> Self {
        Self {
            status,
            state: None,
            limit_pressure_pa: None,
            residual: None,
            iterations: 0,
            discretisation_error: None,
            all: None,
            model: None,
            errors: None,
            warning: None,
            message,
        }
    }

    fn of(solution: &Solution<f64>) -> Self {
        let blank = Self::without_state(word(solution.status), None);
        Self {
            state: (solution.status == Status::Solved).then_some(solution.state),
            limit_pressure_pa: solution.limit_pressure_pa.filter(|limit| limit.is_finite()),
            residual: Some(solution.residual),
            iterations: solution.iterations,
            ..blank
        }
    }

    fn found(found: &SectionAnswer) -> Self {
        let blank = Self::without_state(word(found.status), None);
        let SectionAnswer { state, limit_pressure_pa, iterations, error, .. } = *found;
        Self { state, limit_pressure_pa, iterations, discretisation_error: error, ..blank }
    }

    /// Appends the answer as JSON. By hand, since a derived one would look for characters to escape in the names of its fields.
    fn write(&self, id: &Value, out: &mut Vec<u8>) -> serde_json::Result<()> {
        let number = |of: fn(&State<f64>) -> f64| self.state.as_ref().map(of);
        append(out, "{\"id\":", id)?;
        append(out, ",\"status\":", self.status)?;
        append(out, ",\"pressure_pa\":", &number(|state| state.pressure_pa))?;
        append(out, ",\"axial_stretch\":", &number(|state| state.axial_stretch))?;
        append(out, ",\"inner_radius_m\":", &number(|state| state.inner_radius_m))?;
        append(out, ",\"outer_radius_m\":", &number(|state| state.outer_radius_m))?;
        append(out, ",\"twist_rad\":", &number(|state| state.twist_rad))?;
        append(out, ",\"bend_angle_rad\":", &number(|state| state.bend_angle_rad))?;
        if let Some(limit_pressure_pa) = &self.limit_pressure_pa {
            append(out, ",\"limit_pressure_pa\":", limit_pressure_pa)?;
        }
        // An answer with a state has no `null`.
        if self.state.is_none() || self.residual.is_some() {
            append(out, ",\"residual\":", &self.residual)?;
        }
        append(out, ",\"iterations\":", &self.iterations)?;
        if let Some(error) = &self.discretisation_error {
            append(out, ",\"discretisation_error\":", error)?;
        }
        if let Some(all) = &self.all {
            append(out, ",\"solutions\":", &all.solutions.iter().map(Listed::of).collect::<Vec<_>>())?;
            append(out, ",\"solutions_complete\":", &all.complete)?;
        }
        if let Some(model) = self.model {
            append(out, ",\"model\":", model)?;
        }
        if let Some(errors) = &self.errors {
            append(out, ",\"errors\":", errors)?;
        }
        if let Some(warning) = &self.warning {
            append(out, ",\"warnings\":", &[warning])?;
        }
        if let Some(message) = &self.message {
            append(out, ",\"message\":", message)?;
        }
        out.push(b'}');
        Ok(())
    }
}

fn append<T: Serialize + ?Sized>(out: &mut Vec<u8>, field: &str, value: &T) -> serde_json::Result<()> {
    out.extend_from_slice(field.as_bytes());
    serde_json::to_writer(out, value)
}
