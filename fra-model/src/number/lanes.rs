//! Several floats side by side.

use crate::number::arithmetic::Arithmetic;

/// Most values side by side.
pub const LANES: usize = 8;

/// Arithmetic on several floats at once.
pub trait Lanes<T>: Arithmetic {
    /// Number of floats, at most [`LANES`].
    const COUNT: usize;

    /// The first floats of an array; `self` only tells the type.
    fn load(self, values: &[T; LANES]) -> Self;

    /// Writes to the front of an array.
    fn store(self, values: &mut [T; LANES]);
}

/// A number of each of several actuators.
pub(crate) type Column<T> = [T; LANES];
