//! Dimensions, and factors to SI as exact fractions.

/// Exponents of meter, kilogram, second, kelvin, radian and ampere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dimension(pub(super) [i16; 6]);

impl Dimension {
    pub(crate) const RATIO: Self = Self([0; 6]);
    pub(crate) const LENGTH: Self = Self([1, 0, 0, 0, 0, 0]);
    pub(crate) const AREA: Self = Self([2, 0, 0, 0, 0, 0]);
    pub(crate) const VOLUME: Self = Self([3, 0, 0, 0, 0, 0]);
    pub(crate) const MASS: Self = Self([0, 1, 0, 0, 0, 0]);
    pub(crate) const TIME: Self = Self([0, 0, 1, 0, 0, 0]);
    pub(crate) const TEMPERATURE: Self = Self([0, 0, 0, 1, 0, 0]);
    pub(crate) const ANGLE: Self = Self([0, 0, 0, 0, 1, 0]);
    pub(crate) const PRESSURE: Self = Self([-1, 1, -2, 0, 0, 0]);
    pub(crate) const FORCE: Self = Self([1, 1, -2, 0, 0, 0]);
    pub(crate) const STIFFNESS: Self = Self([0, 1, -2, 0, 0, 0]);
    pub(crate) const POWER: Self = Self([2, 1, -3, 0, 0, 0]);
    pub(crate) const VOLTAGE: Self = Self([2, 1, -3, 0, 0, -1]);
    pub(crate) const DENSITY: Self = Self([-3, 1, 0, 0, 0, 0]);
    pub(crate) const FREQUENCY: Self = Self([0, 0, -1, 0, 0, 0]);
    pub(crate) const SPEED: Self = Self([1, 0, -1, 0, 0, 0]);
    pub(crate) const ANGULAR_SPEED: Self = Self([0, 0, -1, 0, 1, 0]);
    pub(crate) const PRESSURE_RATE: Self = Self([-1, 1, -3, 0, 0, 0]);
    pub(crate) const VOLUME_FLOW: Self = Self([3, 0, -1, 0, 0, 0]);
    pub(crate) const SONIC_CONDUCTANCE: Self = Self([4, -1, 1, 0, 0, 0]);
    pub(crate) const HEAT_CONDUCTANCE: Self = Self([2, 1, -3, -1, 0, 0]);

    /// Name of a quantity of this dimension in messages, with its article.
    pub(crate) fn name(self) -> &'static str {
        const NAMES: [(Dimension, &str); 21] = [
            (Dimension::RATIO, "a plain number"),
            (Dimension::LENGTH, "a length"),
            (Dimension::AREA, "an area"),
            (Dimension::VOLUME, "a volume"),
            (Dimension::MASS, "a mass"),
            (Dimension::TIME, "a time"),
            (Dimension::TEMPERATURE, "a temperature"),
            (Dimension::ANGLE, "an angle"),
            (Dimension::PRESSURE, "a pressure"),
            (Dimension::FORCE, "a force"),
            (Dimension::STIFFNESS, "a stiffness"),
            (Dimension::POWER, "a power"),
            (Dimension::VOLTAGE, "a voltage"),
            (Dimension::DENSITY, "a density"),
            (Dimension::FREQUENCY, "a rate"),
            (Dimension::SPEED, "a speed"),
            (Dimension::ANGULAR_SPEED, "an angular speed"),
            (Dimension::PRESSURE_RATE, "a pressure rate"),
            (Dimension::VOLUME_FLOW, "a volume flow"),
            (Dimension::SONIC_CONDUCTANCE, "a sonic conductance"),
            (Dimension::HEAT_CONDUCTANCE, "a heat conductance"),
        ];
        NAMES.iter().find(|(dimension, _)| *dimension == self).map_or("something else", |(_, name)| name)
    }

    fn combine(self, other: Self, sign: i16) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + sign * other.0[i]))
    }
}

/// Conversion of a number in some unit to SI: `value * numerator / denominator + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) dimension: Dimension,
    pub(super) numerator: f64,
    pub(super) denominator: f64,
    pub(super) offset: f64,
}

impl Scale {
    pub(super) const ONE: Self = Self::new(Dimension::RATIO, 1.0, 1.0);

    pub(crate) const fn new(dimension: Dimension, numerator: f64, denominator: f64) -> Self {
        Self { dimension, numerator, denominator, offset: 0.0 }
    }

    /// A value in this unit, in SI units.
    pub(crate) fn to_si(self, value: f64) -> f64 {
        value * self.numerator / self.denominator + self.offset
    }

    /// An SI value in this unit.
    pub(crate) fn of_si(self, si: f64) -> f64 {
        (si - self.offset) * self.denominator / self.numerator
    }

    pub(super) fn times(self, other: Self) -> Self {
        let dimension = self.dimension.combine(other.dimension, 1);
        Self::new(dimension, self.numerator * other.numerator, self.denominator * other.denominator)
    }

    pub(super) fn over(self, other: Self) -> Self {
        let dimension = self.dimension.combine(other.dimension, -1);
        Self::new(dimension, self.numerator * other.denominator, self.denominator * other.numerator)
    }

    pub(super) fn power(self, exponent: i32) -> Self {
        if exponent == 1 {
            return self;
        }
        let one_step = if exponent < 0 { Self::over } else { Self::times };
        (0..exponent.unsigned_abs()).fold(Self::ONE, |product, _| one_step(product, self))
    }
}
