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
mod materials;
mod refused;
mod solve;

use pyo3::prelude::*;

/// The extension module.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::actuators::Actuators;
    #[pymodule_export]
    use super::materials::{castable_elastomer, castable_elastomers};
    #[pymodule_export]
    use super::refused::Refused;

    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
