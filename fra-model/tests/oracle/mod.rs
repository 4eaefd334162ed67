//! An independent solver of the model of the straight tube and of the bend: stresses instead of energies, continuation in the
//! arclength instead of the volume, numbers of twice the digits.

pub(crate) mod bent;
pub(crate) mod condition;
pub(crate) mod number;
pub(crate) mod path;
pub(crate) mod polish;
pub(crate) mod sample;
pub(crate) mod scalar;
pub(crate) mod section;
pub(crate) mod straight;
pub(crate) mod table;
pub(crate) mod tally;
pub(crate) mod wall;
