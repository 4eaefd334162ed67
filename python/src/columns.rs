//! Parameters of actuators as columns, each of one value or of one a row.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A column of numbers from Python.
pub(crate) type Numbers<'py> = PyReadonlyArray1<'py, f64>;
/// A column of codes from Python.
type Codes<'py> = PyReadonlyArray1<'py, i8>;

/// A winding from Python: angle, families, modulus, placement, thickness, radius.
#[derive(FromPyObject)]
pub(crate) struct Winding<'py>(Numbers<'py>, Codes<'py>, Numbers<'py>, Codes<'py>, Numbers<'py>, Numbers<'py>);

/// The other columns from Python: motion, inner radius, outer radius, length, law, C1 (of a neo-Hookean wall the shear modulus), C2, C3.
#[derive(FromPyObject)]
pub(crate) struct Tube<'py>(
    Codes<'py>,
    Numbers<'py>,
    Numbers<'py>,
    Numbers<'py>,
    Codes<'py>,
    Numbers<'py>,
    Numbers<'py>,
    Numbers<'py>,
);

/// A column with one value for all rows, or one a row.
#[derive(Clone, Copy)]
struct Column<'a, T>(&'a [T]);

impl<'a, T: Copy> Column<'a, T> {
    fn new<'py>(array: &'a PyReadonlyArray1<'py, T>, rows: usize) -> PyResult<Self>
    where
        T: numpy::Element,
    {
        let values = array.as_slice()?;
        if values.len() == 1 || values.len() == rows {
            return Ok(Self(values));
        }
        Err(PyValueError::new_err(format!("a column has {} values: 1 or {rows} are allowed", values.len())))
    }

    fn at(self, row: usize) -> T {
        self.0[if self.0.len() == 1 { 0 } else { row }]
    }
}

/// The columns of a number of actuators, checked for their lengths and their codes.
pub(crate) struct Columns<'a> {
    rows: usize,
    motion: Column<'a, i8>,
    law: Column<'a, i8>,
    /// Inner and outer radius, length, and the coefficients of the material.
    sizes: [Column<'a, f64>; 3],
    coefficients: [Column<'a, f64>; 3],
    windings: Vec<Wound<'a>>,
}

struct Wound<'a> {
    families: Column<'a, i8>,
    placement: Column<'a, i8>,
    /// Angle, modulus, thickness, radius.
    numbers: [Column<'a, f64>; 4],
}

impl<'a> Columns<'a> {
    /// # Errors
    /// A column of another length, or one that is not contiguous.
    pub(crate) fn new(rows: usize, tube: &'a Tube<'_>, windings: &'a [Winding<'_>]) -> PyResult<Self> {
        let Tube(motion, inner, outer, length, law, c1, c2, c3) = tube;
        let windings = windings.iter().map(|Winding(angle, families, modulus, placement, thickness, radius)| {
            let [a, b, c, d] = [angle, modulus, thickness, radius].map(|column| Column::new(column, rows));
            let (families, placement) = (Column::new(families, rows)?, Column::new(placement, rows)?);
            Ok(Wound { families, placement, numbers: [a?, b?, c?, d?] })
        });
        let [inner, outer, length] = [inner, outer, length].map(|column| Column::new(column, rows));
        let [c1, c2, c3] = [c1, c2, c3].map(|column| Column::new(column, rows));
        Ok(Self {
            rows,
            motion: Column::new(motion, rows)?,
            law: Column::new(law, rows)?,
            sizes: [inner?, outer?, length?],
            coefficients: [c1?, c2?, c3?],
            windings: windings.collect::<PyResult<_>>()?,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Whether there is a second winding.
    pub(crate) fn has_second(&self) -> bool {
        self.windings.len() > 1
    }

    /// The actuator of a row, with its first winding.
    pub(crate) fn parameters(&self, row: usize) -> ActuatorParameters<f64> {
        let [inner_radius_m, outer_radius_m, length_m] = self.sizes.map(|column| column.at(row));
        let c_pa = self.coefficients.map(|column| column.at(row));
        let material = match self.law.at(row) {
            0 => Material::NeoHookean { shear_modulus_pa: c_pa[0] },
            _ => Material::Yeoh { c_pa },
        };
        let motion = Motion::ALL[usize::from(self.motion.at(row).clamp(0, 3).unsigned_abs())];
        let fiber = self.windings.first().map(|winding| winding.fiber(row));
        ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m, material, fiber }
    }

    /// The second winding of a row.
    pub(crate) fn second(&self, row: usize) -> Option<Fiber<f64>> {
        self.windings.get(1).map(|winding| winding.fiber(row))
    }
}

impl Wound<'_> {
    fn fiber(&self, row: usize) -> Fiber<f64> {
        let [angle_rad, modulus_pa, thickness_m, radius_m] = self.numbers.map(|column| column.at(row));
        let placement = match self.placement.at(row) {
            0 => Placement::Sheet,
            1 => Placement::Layer,
            _ => Placement::Smeared,
        };
        let families = if self.families.at(row) == 1 { Families::One } else { Families::Two };
        Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m }
    }
}
