//! Actuators, built once and solved for any number of pressures or deformations.

use fra_model::{Actuator, PressureRange, Solution};
use numpy::{IntoPyArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::answers::{Arrays, in_order};
use super::arguments::{Loads, choice, parameter, target, values};
use super::body::{Body, Built, forward_of_columns};
use super::columns::{Columns, Numbers, Tube, Winding};
use super::derivatives::{Fixed, SensitivityQuery};
use super::refused::Refusal;
use super::solve::numbers;

/// Built actuators, in the flat order of their array.
#[pyclass(frozen, module = "softlimb._native")]
pub(crate) struct Actuators {
    built: Built,
}

#[pymethods]
impl Actuators {
    #[new]
    fn new(
        py: Python<'_>,
        rows: usize,
        tube: Tube<'_>,
        windings: Vec<Winding<'_>>,
        stretch_max: Option<Numbers<'_>>,
    ) -> PyResult<Self> {
        let columns = Columns::new(rows, &tube, &windings)?;
        let stretch_max = stretches(stretch_max, rows)?;
        Ok(Self { built: Built { body: py.detach(|| Body::new(&columns))?, stretch_max } })
    }

    fn __len__(&self) -> usize {
        self.built.body.len()
    }

    /// Equilibria at gauge pressures, passing through the actuators again and again.
    fn forward<'py>(
        &self,
        py: Python<'py>,
        pressures_pa: Numbers<'py>,
        loads: Option<(Numbers<'py>, Numbers<'py>)>,
        model: &str,
        tolerance: f64,
    ) -> PyResult<Arrays<'py>> {
        let choice = choice(model, tolerance)?;
        let (pressures, loads) = (values(&pressures_pa)?, Loads::new(loads, pressures_pa.len())?);
        let table = py.detach(|| {
            Refusal::unless_finite("pressure_pa", &pressures)?;
            loads.check()?;
            self.built.forward(&pressures, choice, &loads)
        })?;
        Ok(table.into_arrays(py))
    }

    /// Gauge pressures in a range that reach deformations, passing through the actuators again and again.
    #[allow(clippy::too_many_arguments, reason = "one caller, in Python, which names them")]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        targets: Numbers<'py>,
        loads: Option<(Numbers<'py>, Numbers<'py>)>,
        range_pa: Option<[f64; 2]>,
        model: &str,
        tolerance: f64,
    ) -> PyResult<Arrays<'py>> {
        let (choice, target) = (choice(model, tolerance)?, target(quantity)?);
        let (targets, loads) = (values(&targets)?, Loads::new(loads, targets.len())?);
        let range = range(range_pa);
        let table = py.detach(|| {
            range.check().map_err(|error| Refusal::new(0, error))?;
            loads.check()?;
            let targets: Vec<_> = targets.iter().map(|value| target(*value)).collect();
            self.built.inverse(&targets, choice, &loads, range)
        })?;
        Ok(table.into_arrays(py))
    }

    /// All equilibria in a range of gauge pressures that have deformations: the number of each row and whether the search was complete, then their
    /// numbers one after the other.
    fn inverse_all<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        targets: Numbers<'py>,
        loads: Option<(Numbers<'py>, Numbers<'py>)>,
        range_pa: Option<[f64; 2]>,
    ) -> PyResult<Arrays<'py>> {
        let (target, loads) = (target(quantity)?, Loads::new(loads, targets.len())?);
        let targets = values(&targets)?;
        let range = range(range_pa);
        let actuators = self.list();
        let all = py.detach(|| {
            range.check().map_err(|error| Refusal::new(0, error))?;
            loads.check()?;
            in_order(targets.len(), |i| {
                let mut states = Vec::new();
                let mut each = |found: &Solution<f64>| states.push(numbers(&found.state));
                let found =
                    actuators[i % actuators.len()].inverse_all(&range, target(targets[i]), &loads.at(i), &mut each);
                let is_complete = found.map_err(|error| Refusal::new(i, error))?;
                Ok((states, is_complete))
            })
        })?;
        let counts = all.iter().map(|(states, _)| i32::try_from(states.len()).unwrap_or(i32::MAX));
        let complete = all.iter().map(|(_, is_complete)| i8::from(*is_complete));
        let column =
            |index: usize| all.iter().flat_map(move |(states, _)| states.iter().map(move |state| state[index]));
        Ok((
            vec![complete.collect::<Vec<_>>().into_pyarray(py)],
            counts.collect::<Vec<_>>().into_pyarray(py),
            (0..8).map(|index| column(index).collect::<Vec<_>>().into_pyarray(py)).collect(),
        ))
    }

    /// Derivatives of equilibria by one input: at gauge pressures, or with a deformation kept.
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        of: &str,
        quantity: &str,
        given: Numbers<'py>,
        loads: Option<(Numbers<'py>, Numbers<'py>)>,
    ) -> PyResult<Arrays<'py>> {
        let (values, loads) = (values(&given)?, Loads::new(loads, given.len())?);
        let fixed = if quantity == "pressure_pa" { Fixed::Pressure } else { Fixed::Target(target(quantity)?) };
        let query = SensitivityQuery { of: parameter(of)?, fixed, values: &values, loads: &loads };
        let actuators = self.list();
        let table = py.detach(|| {
            loads.check()?;
            query.solve(actuators)
        })?;
        Ok(table.into_arrays(py))
    }

    /// Loads that hold the ends: status; force, torque, their derivatives by the pressure and by length and twist, lumen volume.
    fn blocked<'py>(
        &self,
        py: Python<'py>,
        pressures_pa: Numbers<'py>,
        stretches: Numbers<'py>,
        twists_rad: Numbers<'py>,
    ) -> PyResult<Arrays<'py>> {
        let (pressures, stretches, twists) = (values(&pressures_pa)?, values(&stretches)?, values(&twists_rad)?);
        let actuators = self.list();
        if stretches.len() != pressures.len() || twists.len() != pressures.len() {
            return Err(PyValueError::new_err("pressures, stretches and twists differ in number"));
        }
        let table = py.detach(|| super::blocked::solve(actuators, &pressures, &stretches, &twists))?;
        Ok(table.into_arrays(py))
    }
}

impl Actuators {
    /// The actuators, in the flat order of their array.
    pub(crate) fn list(&self) -> &[Actuator<f64>] {
        self.built.body.actuators()
    }
}

/// Largest stretches of the tests of elastomers, one a row, or none.
fn stretches(column: Option<Numbers<'_>>, rows: usize) -> PyResult<Option<Vec<f64>>> {
    let column = column.map(|column| values(&column)).transpose()?;
    if column.as_ref().is_some_and(|column| column.len() != rows) {
        return Err(PyValueError::new_err("a stretch a row, or none"));
    }
    Ok(column)
}

/// Equilibria of straight actuators with one winding or none, each at its own gauge pressure, that are not kept.
#[pyfunction]
pub(crate) fn forward_once<'py>(
    py: Python<'py>,
    rows: usize,
    tube: Tube<'_>,
    windings: Vec<Winding<'_>>,
    stretch_max: Option<Numbers<'_>>,
    pressures_pa: Numbers<'_>,
    loads: Option<(Numbers<'_>, Numbers<'_>)>,
) -> PyResult<Arrays<'py>> {
    let columns = Columns::new(rows, &tube, &windings)?;
    let stretch_max = stretches(stretch_max, rows)?;
    let (pressures, loads) = (values(&pressures_pa)?, Loads::new(loads, rows)?);
    if pressures.len() != rows || columns.has_second() {
        return Err(PyValueError::new_err("a pressure a row, and one winding or none"));
    }
    let table = py.detach(|| {
        Refusal::unless_finite("pressure_pa", &pressures)?;
        loads.check()?;
        forward_of_columns(&columns, stretch_max.as_deref(), &pressures, &loads)
    })?;
    Ok(table.into_arrays(py))
}

/// The pressures of a range, or all that there are.
fn range(range_pa: Option<[f64; 2]>) -> PressureRange<f64> {
    let range = range_pa.map(|[least_pa, most_pa]| PressureRange { least_pa, most_pa });
    range.unwrap_or_else(PressureRange::physical)
}
