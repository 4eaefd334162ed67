//! Castable elastomers by trade name.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use softlimb_scene::{CASTABLE_ELASTOMERS, CastableElastomer};

/// Name, coefficients of the Yeoh law in Pa, least and largest stretch of the test.
type Row = (&'static str, [f64; 3], [f64; 2]);

fn row(elastomer: &CastableElastomer) -> Row {
    (elastomer.name, elastomer.c_pa, elastomer.stretch)
}

/// All castable elastomers.
#[pyfunction]
pub(crate) fn castable_elastomers() -> Vec<Row> {
    CASTABLE_ELASTOMERS.iter().map(row).collect()
}

/// The castable elastomer of a name.
#[pyfunction]
pub(crate) fn castable_elastomer(name: &str) -> PyResult<Row> {
    let found = softlimb_scene::castable_elastomer(name);
    let unknown = |help: String| {
        let help = help.replace("`softlimb materials` lists", "softlimb.castable_elastomers() lists");
        PyValueError::new_err(format!("material = {name:?} is no known elastomer: {help}"))
    };
    found.map(row).map_err(unknown)
}
