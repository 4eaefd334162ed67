//! Finite elements of the wall's half-plane: what the ends and the pitch of a thread do, which no uniform section knows.
//!
//! The wall is a body of revolution that may twist: unknowns are the change of the radius, the turn about the axis and the shift along
//! it, as functions of radius and axial place, in nine-node rectangles with three discontinuous pressures each, exactly
//! incompressible. `docs/evidence/validation.md` has the results; its mid-length rates are those of the thick-walled tube, which is one of the tests.

mod band;
mod body;
mod element;
mod end_length;
mod mesh;
mod thread;
mod wall;

use fra_model::InvalidParameter;
use thiserror::Error;

pub use end_length::{Delta, EndLength, end_length};
pub use thread::{Thread, ThreadSheet, thread_sheet};

use crate::spacing::evenly;
use softlimb_files::range::OutOfRange;

/// Why there is no calibration.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeridianError {
    /// A parameter is out of its range.
    #[error(transparent)]
    Invalid(#[from] OutOfRange),
    /// The wall has no equilibrium at the pressure.
    #[error("no equilibrium at {:.1} kPa: the last one found is at {:.1} kPa", pressure_pa * 1e-3, last_pa * 1e-3)]
    NoEquilibrium {
        /// The pressure asked for, gauge Pa.
        pressure_pa: f64,
        /// The last pressure with an equilibrium, gauge Pa.
        last_pa: f64,
    },
    /// The actuator neither lengthens nor twists by much, so that a share of that says nothing.
    #[error(
        "it neither lengthens nor twists by much: axial strain {axial_strain:.1e} beside a hoop strain of {hoop_strain:.1e}"
    )]
    NoMotion {
        /// Axial strain at mid-length.
        axial_strain: f64,
        /// Hoop strain of the outer surface there.
        hoop_strain: f64,
    },
    /// No sheet does what the thread does.
    #[error("no sheet is worth the thread: it gives a strain of {strain:.3e}, sheets give {least:.3e} to {most:.3e}")]
    NotMatched {
        /// Axial strain with the thread.
        strain: f64,
        /// The least that a sheet gives.
        least: f64,
        /// The most, by a sheet that does not yield.
        most: f64,
    },
    /// Two meshes differ too much.
    #[error("two meshes differ by {:.0} % of the sheet that the thread is worth", 100.0 * error)]
    TooCoarse {
        /// By how much, as a share.
        error: f64,
    },
}

impl From<InvalidParameter<f64>> for MeridianError {
    fn from(error: InvalidParameter<f64>) -> Self {
        Self::Invalid(error.into())
    }
}

/// Corners across a wall with a line at each of some edges, in rising order, in parts not longer than the wall over `count`.
fn across(outer: f64, edges: &[f64], count: usize) -> Vec<f64> {
    let most = (outer - 1.0) / count as f64;
    let mut corners = vec![1.0];
    let inside = edges.iter().copied().filter(|edge| *edge < outer - 1e-9);
    for to in inside.chain([outer]) {
        let from = corners[corners.len() - 1];
        // An edge on the inner face, or where there is one already.
        if to <= from + 1e-9 {
            continue;
        }
        let number = ((to - from) / most * (1.0 - 1e-12)).ceil().max(1.0) as usize;
        corners.extend(evenly(from, to, number).skip(1));
    }
    corners
}
