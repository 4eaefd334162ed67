//! Questions to the actuator model from other programs: a JSON object a line in, one a line out, in order.
//!
//! `docs/reference/eval-batch.md` describes the interface.

use std::io::{self, BufRead, Write};

use fra_model::{Actuator, InvalidParameter, Load, Real, Solution, State, Status};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::complaint;
use super::convert;
use super::request::{Case, Model, Question, Request};
use super::section_fe::{self, Discretisation, Found};
use super::series::{SeriesAnswer, SeriesRequest};
use softlimb_files::object::Object;

/// The precision a batch is computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// Double precision, as on the host.
    F64,
    /// Single precision, as on the MCU.
    F32,
}

/// One line of output.
#[derive(Serialize)]
#[serde(untagged)]
enum Reply {
    Actuator(Answer),
    Series(SeriesAnswer),
}

#[derive(Serialize)]
struct Answer {
    id: Value,
    status: &'static str,
    pressure_pa: Option<f64>,
    axial_stretch: Option<f64>,
    inner_radius_m: Option<f64>,
    outer_radius_m: Option<f64>,
    twist_rad: Option<f64>,
    bend_angle_rad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_pressure_pa: Option<f64>,
    residual: Option<f64>,
    iterations: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    discretisation_error: Option<Discretisation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<String>,
}

/// Answers every line of `input` on `output`. Empty lines are passed over.
///
/// # Errors
/// Only what reading and writing raise: a line that cannot be answered is answered with its status.
pub fn batch(input: impl BufRead, output: impl Write, scalar: Scalar) -> io::Result<()> {
    let mut output = io::BufWriter::new(output);
    for (index, line) in input.split(b'\n').enumerate() {
        let line = line?;
        if line.trim_ascii().is_empty() {
            continue;
        }
        let answer = answer(&line, scalar).unwrap_or_else(|(id, message)| {
            Reply::Actuator(Answer::without_state(id, "invalid", Some(format!("line {}: {message}", index + 1))))
        });
        serde_json::to_writer(&mut output, &answer)?;
        output.write_all(b"\n")?;
    }
    output.flush()
}

/// An answer, or the `id` and what is wrong.
type Answered<T> = Result<T, (Value, String)>;

fn answer(line: &[u8], scalar: Scalar) -> Answered<Reply> {
    if is_about_a_series(line) {
        series(line, scalar).map(Reply::Series)
    } else {
        actuator(line, scalar).map(Reply::Actuator)
    }
}

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

fn actuator(line: &[u8], scalar: Scalar) -> Answered<Answer> {
    let request: Request = parsed(line)?;
    let case = request.case().map_err(|message| (request.id.clone(), message))?;
    let solved = match (case.model, scalar) {
        (Model::Analytic, Scalar::F64) => solve::<f64>(&case).map_err(|error| error.to_string()),
        (Model::Analytic, Scalar::F32) => solve::<f32>(&case).map_err(|error| error.to_string()),
        (Model::SectionFe, Scalar::F64) => return by_section(request.id, &case),
        (Model::SectionFe, Scalar::F32) => Err("`model` \"section-fe\" has no single precision".into()),
    };
    match solved {
        Ok(solution) => Ok(Answer::of(request.id, &solution)),
        Err(message) => Err((request.id, message)),
    }
}

fn by_section(id: Value, case: &Case) -> Answered<Answer> {
    // Checked first in the unit it is written in, as for the other model.
    let checked = Actuator::new(&case.parameters).map_err(|error| as_written(error).to_string());
    match checked.and_then(|_| section_fe::solve(case)) {
        Ok(found) => Ok(Answer::found(id, &found)),
        Err(message) => Err((id, message)),
    }
}

fn series(line: &[u8], scalar: Scalar) -> Answered<SeriesAnswer> {
    let request: SeriesRequest = parsed(line)?;
    let answered = request.case().and_then(|case| match scalar {
        Scalar::F64 => case.answer::<f64>(request.id.clone()),
        Scalar::F32 => case.answer::<f32>(request.id.clone()),
    });
    answered.map_err(|message| (request.id, message))
}

/// The `id` of a line that is JSON but no request, so that its answer can be told from others.
fn id_of(line: &[u8]) -> Value {
    let parsed = serde_json::from_slice::<Value>(line).ok();
    parsed.and_then(|value| value.get("id").cloned()).unwrap_or(Value::Null)
}

fn solve<T: Real>(case: &Case) -> Result<Solution<f64>, InvalidParameter<f64>> {
    let wide = convert::invalid::<T>;
    // Checked first in the precision and unit it is written in, so that a message quotes the value as written.
    Actuator::new(&case.parameters).map_err(as_written)?;
    let actuator = Actuator::<T>::new(&convert::parameters(&case.parameters)).map_err(wide)?;
    let load: Load<T> = convert::load(&case.load);
    let solution = match case.question {
        Question::Forward { pressure_pa } => actuator.forward(nalgebra::convert(pressure_pa), &load),
        Question::Inverse { target } => actuator.inverse(convert::target(target), &load),
    }
    .map_err(wide)?;
    Ok(Solution {
        status: solution.status,
        state: convert::state(&solution.state),
        limit_pressure_pa: solution.limit_pressure_pa.map(convert::wide),
        residual: convert::wide(solution.residual),
        iterations: solution.iterations,
    })
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

/// A status in the words of the interface.
pub(super) fn word(status: Status) -> &'static str {
    match status {
        Status::Solved => "ok",
        Status::NoSolution => "no_solution",
        Status::NotConverged => "not_converged",
    }
}

impl Answer {
    fn without_state(id: Value, status: &'static str, message: Option<String>) -> Self {
        Self {
            id,
            status,
            pressure_pa: None,
            axial_stretch: None,
            inner_radius_m: None,
            outer_radius_m: None,
            twist_rad: None,
            bend_angle_rad: None,
            limit_pressure_pa: None,
            residual: None,
            iterations: 0,
            discretisation_error: None,
            message,
        }
    }

    fn of(id: Value, solution: &Solution<f64>) -> Self {
        let blank = Self::without_state(id, word(solution.status), None);
        let common = Self {
            limit_pressure_pa: solution.limit_pressure_pa,
            residual: Some(solution.residual),
            iterations: solution.iterations,
            ..blank
        };
        if solution.status == Status::Solved { common.with(&solution.state) } else { common }
    }

    fn found(id: Value, found: &Found) -> Self {
        let blank = Self::without_state(id, word(found.status), None);
        let Found { limit_pressure_pa, iterations, error, .. } = *found;
        let common = Self { limit_pressure_pa, iterations, discretisation_error: error, ..blank };
        found.state.iter().fold(common, Self::with)
    }

    fn with(self, state: &State<f64>) -> Self {
        Self {
            pressure_pa: Some(state.pressure_pa),
            axial_stretch: Some(state.axial_stretch),
            inner_radius_m: Some(state.inner_radius_m),
            outer_radius_m: Some(state.outer_radius_m),
            twist_rad: Some(state.twist_rad),
            bend_angle_rad: Some(state.bend_angle_rad),
            ..self
        }
    }
}
