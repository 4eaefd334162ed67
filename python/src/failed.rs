//! Failures of scenes as exceptions of Python.

use std::fmt::Display;

use pyo3::prelude::*;
use softlimb::rig::run::RunError;
use softlimb_scene::{Diagnostic, SceneError};

/// The module of the exceptions.
const ERRORS: &str = "softlimb.errors";

/// `softlimb.SceneError`, with the diagnostics.
pub(crate) fn scene_error(py: Python<'_>, error: &SceneError) -> PyErr {
    let of = |diagnostic: Diagnostic| {
        let Diagnostic { message, line, column, label, help } = diagnostic;
        (message, line, column, label, help)
    };
    let diagnostics: Vec<_> = error.diagnostics().into_iter().map(of).collect();
    raised(py, "scene_error", (error.render(false), diagnostics))
}

/// `softlimb.RunError`.
pub(crate) fn not_computed(py: Python<'_>, error: impl Display) -> PyErr {
    raised(py, "RunError", (error.to_string(),))
}

/// `softlimb.SceneError` or `softlimb.RunError`.
pub(crate) fn run_error(py: Python<'_>, error: RunError) -> PyErr {
    match error {
        RunError::Scene(error) => scene_error(py, &error),
        other => not_computed(py, other),
    }
}

/// `softlimb.LogError`.
pub(crate) fn not_read(py: Python<'_>, error: impl Display) -> PyErr {
    raised(py, "LogError", (error.to_string(),))
}

/// The exception that a function of the module of exceptions makes.
fn raised<'py>(py: Python<'py>, make: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py.import(ERRORS).and_then(|module| module.getattr(make)?.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}
