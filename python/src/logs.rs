//! Logs of runs as columns.

use std::path::PathBuf;

use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyList;
use softlimb::results::json;
use softlimb::rig::export::{Values, tables};
use softlimb::rig::{record, report};

use super::failed::not_read;

/// A column: its name, and an array of numbers or a list of words.
type Column<'py> = (String, Bound<'py, PyAny>);
/// The tables by name; the scene's part of the log and the summary as JSON; why the log is incomplete.
type Log<'py> = (Vec<(&'static str, Vec<Column<'py>>)>, String, String, Option<String>);

/// Reads a log: the tables of `softlimb export --csv`, and the summary of `softlimb report --json`.
#[pyfunction]
pub(crate) fn read_log(py: Python<'_>, path: PathBuf) -> PyResult<Log<'_>> {
    let read = py.detach(|| {
        let log = record::read(&path)?;
        let capture = record::read_capture(&path)?;
        Ok((tables(&log, &capture), json(&log.info), json(&report::summary(&log)), log.incomplete))
    });
    let (tables, info, summary, incomplete) = read.map_err(|error: record::RecordError| not_read(py, error))?;
    let column = |values: Values| match values {
        Values::Number(values) => Ok(values.into_pyarray(py).into_any()),
        Values::Whole(values) => Ok(values.into_pyarray(py).into_any()),
        Values::Text(values) => PyList::new(py, values).map(Bound::into_any),
    };
    let tables = tables.into_iter().map(|table| {
        let columns = table.columns.into_iter().map(|each| Ok((each.name, column(each.values)?)));
        Ok((table.name, columns.collect::<PyResult<_>>()?))
    });
    Ok((tables.collect::<PyResult<_>>()?, info, summary, incomplete))
}
