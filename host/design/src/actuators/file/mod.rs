//! Problem files: JSON, described in `docs/reference/actuator-problem.md`. What is wrong is said with field, value, allowed range and line.

mod bounds;
mod segment;
mod winding;

use fra_model::Motion;
use serde::Deserialize;

use super::problem::{MOST, Problem, Segment};
use segment::SegmentSpec;
use softlimb_files::json_line::line_of;
use softlimb_files::object::Object;

/// What is wrong with a problem file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProblemError {
    /// It is no JSON, or not of this format.
    #[error("line {line}, column {column}: {message}")]
    Format {
        /// From 1.
        line: usize,
        /// From 1; 0 for the whole line.
        column: usize,
        /// In the words of the parser.
        message: String,
    },
    /// A value that is not accepted.
    #[error("line {line}: {field} {message}")]
    Value {
        /// From 1.
        line: usize,
        /// As in `segments[0].bounds.wall_m[1]`.
        field: String,
        /// Value and allowed range.
        message: String,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    #[serde(default)]
    shared_pressure: bool,
    weights: Object<Weights>,
    segments: Vec<Object<SegmentSpec>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Weights {
    length_per_m2: Option<f64>,
    outer_radius_per_m2: Option<f64>,
    bend_angle_per_rad2: Option<f64>,
    twist_per_rad2: Option<f64>,
}

/// A field and what is wrong with it; the line is found when the message is made.
type Refused = (String, String);

fn require(accepted: bool, field: &str, value: impl std::fmt::Display, allowed: &str) -> Result<(), Refused> {
    if accepted { Ok(()) } else { Err((field.into(), format!("= {value} is not allowed: {allowed}"))) }
}

fn missing<T>(value: Option<T>, field: String, what: &str) -> Result<T, Refused> {
    value.ok_or_else(|| (field, format!("is missing: {what}")))
}

fn superfluous<T>(value: Option<&T>, field: String, why: &str) -> Result<(), Refused> {
    if value.is_none() { Ok(()) } else { Err((field, format!("is not allowed: {why}"))) }
}

impl Problem {
    /// Reads a problem file.
    ///
    /// # Errors
    /// [`ProblemError`] at the first value that is not accepted.
    pub fn read(text: &str) -> Result<Self, ProblemError> {
        let Object(file) = serde_json::from_str::<Object<File>>(text).map_err(|error| {
            let message = error.to_string();
            let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message).to_owned();
            ProblemError::Format { line: error.line(), column: error.column(), message }
        })?;
        file.problem().map_err(|(field, message)| ProblemError::Value { line: line_of(text, &field), field, message })
    }
}

impl File {
    fn problem(&self) -> Result<Problem, Refused> {
        require(self.format == 1, "format", self.format, "1")?;
        let count = self.segments.len();
        require((1..=MOST).contains(&count), "segments", format!("[{count} items]"), "1 to 1000 items")?;
        let mut segments: Vec<Segment> = Vec::new();
        for (index, Object(spec)) in self.segments.iter().enumerate() {
            let at = format!("segments[{index}]");
            let segment = spec.segment(&at, &self.weights.0)?;
            let (phases, first) =
                (segment.goals.len(), segments.first().map_or(segment.goals.len(), |s| s.goals.len()));
            let allowed = format!("as many as the first segment has: {first}");
            require(phases == first, &format!("{at}.targets"), format!("[{phases} phases]"), &allowed)?;
            segments.push(segment);
        }
        Ok(Problem { segments, shared_pressure: self.shared_pressure })
    }
}

impl Weights {
    fn of(&self, motion: Motion) -> Result<f64, Refused> {
        let (name, value) = match motion {
            Motion::Extension => ("length_per_m2", self.length_per_m2),
            Motion::Expansion => ("outer_radius_per_m2", self.outer_radius_per_m2),
            Motion::Bending => ("bend_angle_per_rad2", self.bend_angle_per_rad2),
            Motion::Twisting => ("twist_per_rad2", self.twist_per_rad2),
        };
        let value = missing(value, format!("weights.{name}"), "a segment has such targets")?;
        require(value >= 0.0, &format!("weights.{name}"), value, ">= 0")?;
        Ok(value)
    }
}
