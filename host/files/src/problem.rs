//! Problems written in JSON: objects with known fields, read strictly; an error names the line and the field.

use std::fmt::Display;

use serde::de::DeserializeOwned;

use crate::json_line::line_of;
use crate::object::Object;

/// Error of a problem file.
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

/// A field and what is wrong with it; the line is found when the message is made.
pub type Refused = (String, String);

/// Reads a problem: the fields as they are written, and the problem they make.
///
/// # Errors
/// [`ProblemError`] at the first value that is not accepted.
pub fn read<F: DeserializeOwned, P>(
    text: &str,
    made: impl FnOnce(&F) -> Result<P, Refused>,
) -> Result<P, ProblemError> {
    let Object(file) = serde_json::from_str::<Object<F>>(text).map_err(|error| {
        let message = error.to_string();
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message).to_owned();
        ProblemError::Format { line: error.line(), column: error.column(), message }
    })?;
    made(&file).map_err(|(field, message)| ProblemError::Value { line: line_of(text, &field), field, message })
}

/// Refuses a value unless `accepted`.
///
/// # Errors
/// [`Refused`] with the field, the value and what is allowed.
pub fn require(accepted: bool, field: &str, value: impl Display, allowed: &str) -> Result<(), Refused> {
    if accepted { Ok(()) } else { Err((field.into(), format!("= {value} is not allowed: {allowed}"))) }
}

/// A value that must be there.
///
/// # Errors
/// [`Refused`] with what belongs there.
pub fn missing<T>(value: Option<T>, field: String, what: &str) -> Result<T, Refused> {
    value.ok_or_else(|| (field, format!("is missing: {what}")))
}

/// Refuses a value that has no meaning.
///
/// # Errors
/// [`Refused`] with the reason.
pub fn superfluous<T>(value: Option<&T>, field: String, why: &str) -> Result<(), Refused> {
    if value.is_none() { Ok(()) } else { Err((field, format!("is not allowed: {why}"))) }
}

/// Requires a lower bound above zero and an upper one that is no less.
///
/// # Errors
/// [`Refused`] with the bound.
pub fn positive_bounds(field: &str, bounds: [f64; 2]) -> Result<(), Refused> {
    require(bounds[0] > 0.0, &format!("{field}[0]"), bounds[0], "> 0")?;
    ordered(field, bounds)
}

/// Requires a lower bound of at least `least` and an upper one that is no less.
///
/// # Errors
/// [`Refused`] with the bound.
pub fn bounds_from(field: &str, bounds: [f64; 2], least: f64) -> Result<(), Refused> {
    require(bounds[0] >= least, &format!("{field}[0]"), bounds[0], &format!(">= {least}"))?;
    ordered(field, bounds)
}

/// Requires an upper bound that is no less than the lower one.
///
/// # Errors
/// [`Refused`] with the upper bound.
pub fn ordered(field: &str, [low, high]: [f64; 2]) -> Result<(), Refused> {
    require(high >= low, &format!("{field}[1]"), high, &format!("at least {low}, the lower bound"))
}
