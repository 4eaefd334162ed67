//! The symbols of units.

use std::f64::consts::PI;

use super::scale::{Dimension, Scale};

/// Every symbol: name, dimension, numerator and denominator of its factor to SI.
#[rustfmt::skip]
pub(super) const SYMBOLS: [(&str, Scale); 55] = [
    ("m", Scale::new(Dimension::LENGTH, 1.0, 1.0)), ("dm", Scale::new(Dimension::LENGTH, 1.0, 1e1)),
    ("cm", Scale::new(Dimension::LENGTH, 1.0, 1e2)), ("mm", Scale::new(Dimension::LENGTH, 1.0, 1e3)),
    ("um", Scale::new(Dimension::LENGTH, 1.0, 1e6)), ("nm", Scale::new(Dimension::LENGTH, 1.0, 1e9)),
    ("in", Scale::new(Dimension::LENGTH, 254.0, 1e4)),
    ("kg", Scale::new(Dimension::MASS, 1.0, 1.0)), ("g", Scale::new(Dimension::MASS, 1.0, 1e3)),
    ("mg", Scale::new(Dimension::MASS, 1.0, 1e6)), ("lb", Scale::new(Dimension::MASS, 45_359_237.0, 1e8)),
    ("s", Scale::new(Dimension::TIME, 1.0, 1.0)), ("ms", Scale::new(Dimension::TIME, 1.0, 1e3)),
    ("us", Scale::new(Dimension::TIME, 1.0, 1e6)), ("min", Scale::new(Dimension::TIME, 60.0, 1.0)),
    ("h", Scale::new(Dimension::TIME, 3600.0, 1.0)), ("Hz", Scale::new(Dimension::FREQUENCY, 1.0, 1.0)),
    ("kHz", Scale::new(Dimension::FREQUENCY, 1e3, 1.0)),
    ("K", Scale::new(Dimension::TEMPERATURE, 1.0, 1.0)),
    ("degC", Scale { offset: 273.15, ..Scale::new(Dimension::TEMPERATURE, 1.0, 1.0) }),
    ("Pa", Scale::new(Dimension::PRESSURE, 1.0, 1.0)), ("hPa", Scale::new(Dimension::PRESSURE, 1e2, 1.0)),
    ("kPa", Scale::new(Dimension::PRESSURE, 1e3, 1.0)), ("MPa", Scale::new(Dimension::PRESSURE, 1e6, 1.0)),
    ("GPa", Scale::new(Dimension::PRESSURE, 1e9, 1.0)), ("bar", Scale::new(Dimension::PRESSURE, 1e5, 1.0)),
    ("mbar", Scale::new(Dimension::PRESSURE, 1e2, 1.0)), ("atm", Scale::new(Dimension::PRESSURE, 101_325.0, 1.0)),
    // One pound-force (0.45359237 kg at 9.80665 m/s2) on one square inch (0.0254 m squared).
    ("psi", Scale::new(Dimension::PRESSURE, 44_482_216_152_605.0, 6_451_600_000.0)),
    ("N", Scale::new(Dimension::FORCE, 1.0, 1.0)), ("mN", Scale::new(Dimension::FORCE, 1.0, 1e3)),
    ("kN", Scale::new(Dimension::FORCE, 1e3, 1.0)),
    ("J", Scale::new(Dimension([2, 1, -2, 0, 0, 0]), 1.0, 1.0)), ("W", Scale::new(Dimension::POWER, 1.0, 1.0)),
    ("mW", Scale::new(Dimension::POWER, 1.0, 1e3)),
    ("V", Scale::new(Dimension::VOLTAGE, 1.0, 1.0)), ("mV", Scale::new(Dimension::VOLTAGE, 1.0, 1e3)),
    ("rad", Scale::new(Dimension::ANGLE, 1.0, 1.0)), ("mrad", Scale::new(Dimension::ANGLE, 1.0, 1e3)),
    ("deg", Scale::new(Dimension::ANGLE, PI, 180.0)), ("turn", Scale::new(Dimension::ANGLE, 2.0 * PI, 1.0)),
    ("L", Scale::new(Dimension::VOLUME, 1.0, 1e3)), ("l", Scale::new(Dimension::VOLUME, 1.0, 1e3)),
    ("dL", Scale::new(Dimension::VOLUME, 1.0, 1e4)), ("cL", Scale::new(Dimension::VOLUME, 1.0, 1e5)),
    ("mL", Scale::new(Dimension::VOLUME, 1.0, 1e6)), ("ml", Scale::new(Dimension::VOLUME, 1.0, 1e6)),
    ("uL", Scale::new(Dimension::VOLUME, 1.0, 1e9)), ("cc", Scale::new(Dimension::VOLUME, 1.0, 1e6)),
    // Air is counted as volume at the reference atmosphere of ISO 8778.
    ("NL", Scale::new(Dimension::VOLUME, 1.0, 1e3)), ("NmL", Scale::new(Dimension::VOLUME, 1.0, 1e6)),
    ("%", Scale::new(Dimension::RATIO, 1.0, 1e2)), ("ppm", Scale::new(Dimension::RATIO, 1.0, 1e6)),
    ("1", Scale::ONE), ("ul", Scale::new(Dimension::VOLUME, 1.0, 1e9)),
];

/// Symbols of one dimension, in the order of the table.
pub(crate) fn symbols_of(dimension: Dimension) -> impl Iterator<Item = &'static str> {
    SYMBOLS.iter().filter(move |(_, scale)| scale.dimension == dimension).map(|(symbol, _)| *symbol)
}

/// All symbols.
pub(crate) fn symbols() -> impl Iterator<Item = &'static str> {
    SYMBOLS.iter().map(|(symbol, _)| *symbol)
}
