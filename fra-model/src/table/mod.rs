//! Tables in place of the solver: the pressure for a deformation, and the volume at a pressure, as polynomials of low degree.
//!
//! A table holds no physics. Its builder compares it with an [`Actuator`](crate::Actuator); this module is the
//! evaluation, made such that the comparison can be complete: the argument is rounded to a grid, so that an [`InverseTable`] has a few
//! ten thousand values in all and its error, its limits and its rise can be checked at every one of them, rounding of the scalar
//! included.

mod chebyshev;
mod inverse;
mod volume;

pub use inverse::{Argument, InverseTable, Lookup, NotFinite, TableParameters};
pub use volume::{Volume, VolumeTable};

/// Most coefficients of a table: polynomials up to degree 16.
pub const TABLE_COEFFICIENTS: usize = 17;
