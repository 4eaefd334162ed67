//! The native part of the Python package `softlimb`: arrays in, arrays out. `python/softlimb` gives them names, shapes and units.
//!
//! Everything that computes runs without the interpreter's lock.

mod actuators;
mod answers;
mod arguments;
mod blocked;
mod body;
mod columns;
mod derivatives;
mod failed;
mod logs;
mod materials;
mod refused;
mod runs;
mod scenes;
mod series;
mod session;
mod solve;
mod studies;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command with the words of a command line, the program's name before them; its exit code.
#[pyfunction]
fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| softlimb::cli::main_of(words))
}

/// The extension module.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::actuators::{Actuators, forward_once};
    #[pymodule_export]
    use super::logs::read_log;
    #[pymodule_export]
    use super::main;
    #[pymodule_export]
    use super::materials::{castable_elastomer, castable_elastomers};
    #[pymodule_export]
    use super::refused::Refused;
    #[pymodule_export]
    use super::scenes::Scene;
    #[pymodule_export]
    use super::series::solve_series;
    #[pymodule_export]
    use super::session::Session;
    #[pymodule_export]
    use super::studies::read_study;

    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
