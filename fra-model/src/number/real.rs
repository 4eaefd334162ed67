//! Scalar of the model.

use nalgebra::RealField;

/// The scalar the model is generic over: `f32` on the MCU, `f64` on the host, dual numbers for exact derivatives.
pub trait Real: RealField + Copy {}

impl<T: RealField + Copy> Real for T {}

/// A constant of the source in the scalar of the model.
#[inline]
pub(crate) fn real<T: Real>(value: f64) -> T {
    nalgebra::convert(value)
}

/// The machine epsilon of the scalar.
#[inline]
pub(crate) fn epsilon<T: Real>() -> T {
    T::default_epsilon()
}
