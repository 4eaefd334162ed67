//! Tables for a device: the lowest degree that keeps the budget.

use fra_model::{Argument, InverseTable, StateQuantity, TABLE_COEFFICIENTS};

use super::chebyshev::{coefficients, rounded, tail};
use super::verify::{air_error, inverse_table};
use super::{AIR_ERROR_MAX, DenseTable, NoTable, Subject, verify};

/// Grids to try: the finest first; a coarser one rises where rounding makes a finer one waver.
const STEPS: [u16; 5] = [32_768, 16_384, 8192, 4096, 2048];

/// Pieces of the dense table that stands for the model: the second number where the first is not accurate enough.
const PIECES: [usize; 2] = [256, 2048];

/// Share of the budget that the dense table may take of it before more pieces are tried.
const DENSE_SHARE: f64 = 0.02;

/// An inverse table with its verified error.
#[derive(Clone, Debug, PartialEq)]
pub struct InverseFit {
    /// Setpoint at zero pressure, SI units.
    pub from: f32,
    /// Setpoint at the highest pressure, SI units.
    pub to: f32,
    /// What the polynomial is a function of.
    pub argument: Argument,
    /// Steps of the grid.
    pub steps: u16,
    /// Highest pressure, gauge Pa: full scale.
    pub pressure_max_pa: f32,
    /// Chebyshev coefficients, Pa.
    pub coefficients_pa: Vec<f32>,
    /// Verified error over all single-precision setpoints of the range, as a share of full scale.
    pub error: f64,
}

impl InverseFit {
    /// The table as the device builds it; `None` if it would refuse it.
    pub fn table(&self) -> Option<InverseTable<f32>> {
        inverse_table(self)
    }
}

/// A volume table with its error.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeFit {
    /// Highest pressure, gauge Pa.
    pub pressure_max_pa: f32,
    /// Chebyshev coefficients, m3.
    pub coefficients_m3: Vec<f32>,
    /// Largest error found, as a share of the air that a pressure change takes.
    pub error: f64,
}

/// Everything a device looks up instead of solving its model.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceTables {
    /// The volume over the pressure.
    pub volume: VolumeFit,
    /// The pressure over the setpoint; none where the setpoint is the pressure.
    pub inverse: Option<InverseFit>,
}

/// Builds and verifies the tables of an actuator. `budget` is the largest error of the inverse table as a share of full scale,
/// `atmosphere_pa` the absolute pressure around, Pa.
///
/// # Errors
/// [`NoTable`] says why there are none.
pub fn device_tables(subject: &Subject, budget: f64, atmosphere_pa: f64) -> Result<DeviceTables, NoTable> {
    let inverse = match subject.kind {
        StateQuantity::Pressure => None,
        _ => Some(inverse(subject, budget)?),
    };
    Ok(DeviceTables { volume: volume(subject, atmosphere_pa)?, inverse })
}

fn volume(subject: &Subject, atmosphere_pa: f64) -> Result<VolumeFit, NoTable> {
    let highest_pa = subject.curve.pressure_max_pa();
    if highest_pa <= 0.0 {
        return Err(NoTable::NotSolved { pressure_pa: highest_pa });
    }
    let series = coefficients(|share| subject.curve.at(share * highest_pa).volume_m3);
    let mut least = f64::INFINITY;
    for count in 2..=TABLE_COEFFICIENTS {
        let coefficients_m3 = rounded(&series, count);
        let fit = VolumeFit { pressure_max_pa: highest_pa as f32, coefficients_m3, error: 0.0 };
        let error = air_error(&fit, subject, atmosphere_pa).unwrap_or(f64::INFINITY);
        if error <= AIR_ERROR_MAX {
            return Ok(VolumeFit { error, ..fit });
        }
        least = least.min(error);
    }
    Err(NoTable::Volume { least })
}

fn inverse(subject: &Subject, budget: f64) -> Result<InverseFit, NoTable> {
    let mut least: Option<f64> = None;
    for argument in [Argument::Linear, Argument::Root] {
        let exact = dense(subject, argument, budget)?;
        match fit(subject, &exact, budget) {
            Ok(fit) => return Ok(fit),
            Err(Some(error)) => least = Some(least.map_or(error, |least| least.min(error))),
            Err(None) => {}
        }
    }
    Err(NoTable::Inverse { least, budget })
}

fn dense(subject: &Subject, argument: Argument, budget: f64) -> Result<DenseTable, NoTable> {
    let [few, many] = PIECES;
    let table = DenseTable::new(subject, argument, few)?;
    let accurate = table.error_pa() <= DENSE_SHARE * budget * subject.curve.pressure_max_pa();
    if accurate { Ok(table) } else { DenseTable::new(subject, argument, many) }
}

/// The lowest degree on the finest grid that keeps the budget; else the least error of a table that rises.
fn fit(subject: &Subject, exact: &DenseTable, budget: f64) -> Result<InverseFit, Option<f64>> {
    let highest_pa = subject.curve.pressure_max_pa();
    let series = series(exact);
    let mut least: Option<f64> = None;
    for count in 2..=TABLE_COEFFICIENTS {
        // What is cut off bounds the error from above, but not from below by much: most degrees need no closer look.
        if count < TABLE_COEFFICIENTS && tail(&series, count) > 4.0 * budget * highest_pa {
            continue;
        }
        let Some(fit) = rising(subject, exact, &rounded(&series, count)) else { continue };
        if fit.error <= budget {
            return Ok(fit);
        }
        least = Some(least.map_or(fit.error, |least| least.min(fit.error)));
    }
    Err(least)
}

/// The inverse table of one degree (1 to 16), whatever its error, with that error verified; `None` where it rises on no grid.
pub fn inverse_of_degree(subject: &Subject, exact: &DenseTable, degree: usize) -> Option<InverseFit> {
    let count = (degree + 1).clamp(2, TABLE_COEFFICIENTS);
    rising(subject, exact, &rounded(&series(exact), count))
}

/// Coefficients of the pressure over the argument of the dense table.
fn series(exact: &DenseTable) -> Vec<f64> {
    let (from, to) = exact.range();
    coefficients(|u| {
        let share = if exact.argument() == Argument::Root { u * u } else { u };
        exact.pressure_pa(from + (to - from) * share).unwrap_or(f64::NAN)
    })
}

/// The table with these coefficients on the finest grid on which it rises.
fn rising(subject: &Subject, exact: &DenseTable, coefficients_pa: &[f32]) -> Option<InverseFit> {
    let (from, to) = exact.range();
    STEPS.into_iter().find_map(|steps| {
        let fit = InverseFit {
            from: from as f32,
            to: to as f32,
            argument: exact.argument(),
            steps,
            pressure_max_pa: subject.curve.pressure_max_pa() as f32,
            coefficients_pa: coefficients_pa.to_vec(),
            error: 0.0,
        };
        let verified = verify(&fit, exact)?;
        verified.rises.then_some(InverseFit { error: verified.error, ..fit })
    })
}
