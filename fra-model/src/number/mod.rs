//! Numbers of the kernels: floats, dual numbers, double-double numbers, and their elementary functions.

pub(crate) mod arithmetic;
pub(crate) mod double_double;
pub(crate) mod dual;
mod elementary;
pub(crate) mod lanes;
pub(crate) mod real;
pub(crate) mod scalar;

pub(crate) use elementary::sin_cos;
