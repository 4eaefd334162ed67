//! Studies of sweeps.

use std::path::PathBuf;

use pyo3::prelude::*;
use softlimb_scene as scene;

use super::failed::scene_error;

/// The scene files of a checked study, as the study names them, and its number of rows.
#[pyfunction]
pub(crate) fn read_study(py: Python<'_>, path: PathBuf) -> PyResult<(Vec<String>, u64)> {
    let read = py.detach(|| scene::load_study(path));
    read.map(|study| (study.scene_files().map(str::to_owned).collect(), study.rows()))
        .map_err(|error| scene_error(py, &error))
}
