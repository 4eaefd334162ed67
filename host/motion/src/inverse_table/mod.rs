//! Tables of an actuator: what a device looks up instead of solving its model, and a dense one for the host.
//!
//! A table is built from the model in double precision and then compared with it, as the very function in single precision that the
//! device runs, at every value it has ([`verify`]). What cannot be tabulated within the budget is no error but an answer, [`NoTable`].

mod chebyshev;
mod dense;
mod device;
mod subject;
mod verify;

use std::fmt;

pub use dense::DenseTable;
pub use device::{DeviceTables, InverseFit, VolumeFit, device_tables, inverse_of_degree};
pub use subject::Subject;
pub use verify::{AIR_ERROR_MAX, Verified, verify};

/// Why there is no table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoTable {
    /// The quantity turns back on the way to the highest pressure: several pressures answer one setpoint.
    NotMonotone {
        /// Where it turns, gauge Pa.
        pressure_pa: f64,
    },
    /// The model has no equilibrium where the table needs one.
    NotSolved {
        /// Where, gauge Pa.
        pressure_pa: f64,
    },
    /// No table of the pressure keeps the budget.
    Inverse {
        /// The least verified error of a rising table, as a share of the highest pressure; none if no table rises.
        least: Option<f64>,
        /// The budget.
        budget: f64,
    },
    /// No table of the volume is good enough for the pressure loop.
    Volume {
        /// The least error, as a share of the air that a pressure change takes.
        least: f64,
    },
}

impl fmt::Display for NoTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotMonotone { pressure_pa } => {
                write!(f, "its setpoint turns back at {:.2} kPa", pressure_pa * 1e-3)
            }
            Self::NotSolved { pressure_pa } => {
                write!(f, "the model has no equilibrium at {:.2} kPa", pressure_pa * 1e-3)
            }
            Self::Inverse { least: Some(least), budget } => {
                write!(f, "the best table errs by {least:.1e} of full scale, more than {budget:.1e}")
            }
            Self::Inverse { least: None, .. } => f.write_str("no table of it rises from one value to the next"),
            Self::Volume { least } => {
                write!(f, "the best table of its volume errs by {least:.1e}, more than {AIR_ERROR_MAX:.1e}")
            }
        }
    }
}
