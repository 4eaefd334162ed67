//! The lumen's volume at a gauge pressure, and its slope.

use super::chebyshev::Chebyshev;
use super::inverse::NotFinite;
use crate::number::real::{Real, real};
use crate::parameters::{InvalidParameter, require};

/// Largest coefficient, m3: a lumen of a cubic meter is none.
const LARGEST_M3: f64 = 1.0;

/// The volume of an unloaded actuator over its pressure range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeTable<T> {
    pressure_max_pa: T,
    scale: T,
    rest_m3: T,
    polynomial: Chebyshev<T>,
}

/// Result of a lookup in a volume table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume<T> {
    /// Lumen volume, m3; never less than at rest.
    pub volume_m3: T,
    /// `dV/dP` without external load, m3/Pa; never negative.
    pub compliance_m3_per_pa: T,
}

impl<T: Real> VolumeTable<T> {
    /// The Chebyshev series with `coefficients`, m3, over gauge pressures from zero to `pressure_max_pa`, Pa.
    ///
    /// # Errors
    /// [`InvalidParameter`] unless the pressure is finite and at least 1 Pa, there are 1 to 17 coefficients within 1 m3, and the volume at
    /// rest is positive.
    pub fn new(pressure_max_pa: T, coefficients: &[T]) -> Result<Self, InvalidParameter<T>> {
        let scale = T::one() / pressure_max_pa;
        let ranged = pressure_max_pa.is_finite() && pressure_max_pa >= T::one();
        require(ranged, "pressure_max_pa", pressure_max_pa, "finite and at least 1 Pa")?;
        let polynomial = Chebyshev::new(coefficients, real(LARGEST_M3))?;
        let rest_m3 = polynomial.at(T::zero());
        require(rest_m3 > T::zero(), "coefficients", rest_m3, "a positive volume at rest")?;
        Ok(Self { pressure_max_pa, scale, rest_m3, polynomial })
    }

    /// Volume and compliance at a gauge pressure, Pa; outside of the range those of its nearer end.
    ///
    /// # Errors
    /// [`NotFinite`] for NaN and infinities.
    #[inline]
    pub fn lookup(&self, pressure_pa: T) -> Result<Volume<T>, NotFinite> {
        if !pressure_pa.is_finite() {
            return Err(NotFinite);
        }
        let share = (pressure_pa * self.scale).clamp(T::zero(), T::one());
        let (volume, slope) = self.polynomial.with_slope(share);
        Ok(Volume { volume_m3: volume.max(self.rest_m3), compliance_m3_per_pa: (slope * self.scale).max(T::zero()) })
    }

    /// Highest pressure of the table, gauge Pa.
    pub fn pressure_max_pa(&self) -> T {
        self.pressure_max_pa
    }
}
