//! Setpoints between SI values and the integers on the wire.

use crate::error::SetpointError;
use crate::message::SetpointKind;

impl SetpointKind {
    /// Wire units in one SI unit; exact in f32 as well.
    #[must_use]
    pub const fn units_per_si(self) -> f32 {
        match self {
            Self::Pressure => 1.0,
            Self::AxialStretch | Self::Twist | Self::BendAngle => 1e6,
            Self::OuterRadius | Self::InnerRadius => 1e9,
        }
    }

    /// The integer nearest to an SI value (Pa, 1, m or rad); halves away from zero.
    ///
    /// # Errors
    /// [`SetpointError`] when the value is not finite or does not fit.
    pub fn to_wire(self, value_si: f64) -> Result<i32, SetpointError> {
        if !value_si.is_finite() {
            return Err(SetpointError::NotFinite);
        }
        let scaled = value_si * f64::from(self.units_per_si());
        // Within one of the limits, so that the cast below is exact and rounding decides the rest.
        if scaled.abs() > 2_147_483_649.0 {
            return Err(SetpointError::OutOfRange);
        }
        let whole = scaled as i64;
        let fraction = scaled - whole as f64;
        let away = i64::from(fraction >= 0.5) - i64::from(fraction <= -0.5);
        i32::try_from(whole + away).map_err(|_| SetpointError::OutOfRange)
    }

    /// The SI value of an integer, within two roundings of f32.
    #[must_use]
    pub fn from_wire(self, value: i32) -> f32 {
        value as f32 / self.units_per_si()
    }

    /// The SI value of an integer, correctly rounded to f64; [`to_wire`](Self::to_wire) is its exact inverse.
    #[must_use]
    pub fn from_wire_f64(self, value: i32) -> f64 {
        f64::from(value) / f64::from(self.units_per_si())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worked_examples() {
        assert_eq!(SetpointKind::Pressure.to_wire(120_000.4), Ok(120_000));
        assert_eq!(SetpointKind::AxialStretch.to_wire(1.25), Ok(1_250_000));
        assert_eq!(SetpointKind::OuterRadius.to_wire(0.0065), Ok(6_500_000));
        assert_eq!(SetpointKind::InnerRadius.to_wire(1e-9), Ok(1));
        assert_eq!(SetpointKind::Twist.to_wire(-0.5), Ok(-500_000));
        assert_eq!(SetpointKind::BendAngle.to_wire(core::f64::consts::PI), Ok(3_141_593));
        assert_eq!(SetpointKind::OuterRadius.from_wire(6_500_000), 0.0065_f32);
    }

    #[test]
    fn halves_round_away_from_zero_and_nothing_else_does() {
        let pressure = SetpointKind::Pressure;
        assert_eq!(pressure.to_wire(0.5), Ok(1));
        assert_eq!(pressure.to_wire(-0.5), Ok(-1));
        assert_eq!(pressure.to_wire(0.499_999_999_999_999_94), Ok(0));
        assert_eq!(pressure.to_wire(-0.0), Ok(0));
    }

    #[test]
    fn range_ends_exactly_at_32_bits() {
        let pressure = SetpointKind::Pressure;
        assert_eq!(pressure.to_wire(2_147_483_647.0), Ok(i32::MAX));
        assert_eq!(pressure.to_wire(2_147_483_647.5), Err(SetpointError::OutOfRange));
        assert_eq!(pressure.to_wire(-2_147_483_648.0), Ok(i32::MIN));
        assert_eq!(pressure.to_wire(-2_147_483_648.5), Err(SetpointError::OutOfRange));
        assert_eq!(SetpointKind::Twist.to_wire(f64::MAX), Err(SetpointError::OutOfRange));
        assert_eq!(pressure.to_wire(f64::NAN), Err(SetpointError::NotFinite));
        assert_eq!(pressure.to_wire(f64::INFINITY), Err(SetpointError::NotFinite));
    }
}
