//! Units: a small grammar over a table of symbols, with factors kept as exact fractions.
//!
//! ```text
//! unit   = factor { [ " " | "*" | "/" ] factor }        "/" divides by the one factor after it
//! factor = ( symbol | "(" unit ")" ) [ [ "-" ] digit ]
//! ```

use std::f64::consts::PI;

/// Exponents of meter, kilogram, second, kelvin and radian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Dimension([i16; 5]);

impl Dimension {
    pub(super) const RATIO: Self = Self([0; 5]);
    pub(super) const LENGTH: Self = Self([1, 0, 0, 0, 0]);
    pub(super) const VOLUME: Self = Self([3, 0, 0, 0, 0]);
    pub(super) const MASS: Self = Self([0, 1, 0, 0, 0]);
    pub(super) const TIME: Self = Self([0, 0, 1, 0, 0]);
    pub(super) const TEMPERATURE: Self = Self([0, 0, 0, 1, 0]);
    pub(super) const ANGLE: Self = Self([0, 0, 0, 0, 1]);
    pub(super) const PRESSURE: Self = Self([-1, 1, -2, 0, 0]);
    pub(super) const FORCE: Self = Self([1, 1, -2, 0, 0]);
    pub(super) const POWER: Self = Self([2, 1, -3, 0, 0]);
    pub(super) const DENSITY: Self = Self([-3, 1, 0, 0, 0]);
    pub(super) const FREQUENCY: Self = Self([0, 0, -1, 0, 0]);
    pub(super) const SPEED: Self = Self([1, 0, -1, 0, 0]);
    pub(super) const ANGULAR_SPEED: Self = Self([0, 0, -1, 0, 1]);
    pub(super) const PRESSURE_RATE: Self = Self([-1, 1, -3, 0, 0]);
    pub(super) const VOLUME_FLOW: Self = Self([3, 0, -1, 0, 0]);
    pub(super) const SONIC_CONDUCTANCE: Self = Self([4, -1, 1, 0, 0]);
    pub(super) const HEAT_CONDUCTANCE: Self = Self([2, 1, -3, -1, 0]);

    /// What a message calls a quantity of this dimension, with its article.
    pub(super) fn name(self) -> &'static str {
        const NAMES: [(Dimension, &str); 18] = [
            (Dimension::RATIO, "a plain number"),
            (Dimension::LENGTH, "a length"),
            (Dimension::VOLUME, "a volume"),
            (Dimension::MASS, "a mass"),
            (Dimension::TIME, "a time"),
            (Dimension::TEMPERATURE, "a temperature"),
            (Dimension::ANGLE, "an angle"),
            (Dimension::PRESSURE, "a pressure"),
            (Dimension::FORCE, "a force"),
            (Dimension::POWER, "a power"),
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

/// How a number in some unit becomes SI: `value * numerator / denominator + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) dimension: Dimension,
    numerator: f64,
    denominator: f64,
    offset: f64,
}

impl Scale {
    const ONE: Self = Self::new(Dimension::RATIO, 1.0, 1.0);

    pub(super) const fn new(dimension: Dimension, numerator: f64, denominator: f64) -> Self {
        Self { dimension, numerator, denominator, offset: 0.0 }
    }

    /// A value in this unit, in SI units.
    pub(super) fn to_si(self, value: f64) -> f64 {
        value * self.numerator / self.denominator + self.offset
    }

    /// An SI value in this unit.
    pub(super) fn of_si(self, si: f64) -> f64 {
        (si - self.offset) * self.denominator / self.numerator
    }

    fn times(self, other: Self) -> Self {
        let dimension = self.dimension.combine(other.dimension, 1);
        Self::new(dimension, self.numerator * other.numerator, self.denominator * other.denominator)
    }

    fn over(self, other: Self) -> Self {
        let dimension = self.dimension.combine(other.dimension, -1);
        Self::new(dimension, self.numerator * other.denominator, self.denominator * other.numerator)
    }

    fn power(self, exponent: i32) -> Self {
        if exponent == 1 {
            return self;
        }
        let one_step = if exponent < 0 { Self::over } else { Self::times };
        (0..exponent.unsigned_abs()).fold(Self::ONE, |product, _| one_step(product, self))
    }
}

/// Every symbol: name, dimension, numerator and denominator of its factor to SI.
#[rustfmt::skip]
const SYMBOLS: [(&str, Scale); 53] = [
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
    ("J", Scale::new(Dimension([2, 1, -2, 0, 0]), 1.0, 1.0)), ("W", Scale::new(Dimension::POWER, 1.0, 1.0)),
    ("mW", Scale::new(Dimension::POWER, 1.0, 1e3)),
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

/// Longest unit text that is looked at, in bytes; bounds the recursion over parentheses.
const LONGEST: usize = 48;

/// Symbols of one dimension, in the order of the table.
pub(super) fn symbols_of(dimension: Dimension) -> impl Iterator<Item = &'static str> {
    SYMBOLS.iter().filter(move |(_, scale)| scale.dimension == dimension).map(|(symbol, _)| *symbol)
}

/// All symbols.
pub(super) fn symbols() -> impl Iterator<Item = &'static str> {
    SYMBOLS.iter().map(|(symbol, _)| *symbol)
}

/// Reads a unit such as `mm`, `kg/m3` or `dm3/(s bar)`.
///
/// # Errors
/// The part of the text that is not understood.
pub(super) fn parse_unit(text: &str) -> Result<Scale, String> {
    let plain = plain_letters(text);
    if plain.len() > LONGEST {
        return Err(plain);
    }
    let mut cursor = Cursor { rest: plain.as_str() };
    let scale = cursor.product()?;
    if cursor.rest.is_empty() { Ok(scale) } else { Err(cursor.rest.to_owned()) }
}

/// The same unit in the letters of the table: `µm` is `um`, `m³` and `m^3` are `m3`, `°C` is `degC`.
fn plain_letters(text: &str) -> String {
    let text = text.trim().replace("°C", "degC").replace('°', "deg");
    text.chars()
        .filter(|c| *c != '^')
        .map(|c| match c {
            'µ' | 'μ' => 'u',
            '²' => '2',
            '³' => '3',
            '·' | '⋅' => '*',
            other => other,
        })
        .collect()
}

struct Cursor<'a> {
    rest: &'a str,
}

impl Cursor<'_> {
    fn product(&mut self) -> Result<Scale, String> {
        let mut scale = self.factor()?;
        loop {
            self.rest = self.rest.trim_start();
            if self.rest.is_empty() || self.rest.starts_with(')') {
                return Ok(scale);
            }
            scale = if self.eat('/') {
                scale.over(self.factor()?)
            } else {
                self.eat('*');
                scale.times(self.factor()?)
            };
        }
    }

    fn factor(&mut self) -> Result<Scale, String> {
        self.rest = self.rest.trim_start();
        let base = if self.eat('(') {
            let inner = self.product()?;
            if !self.eat(')') {
                return Err("(".to_owned());
            }
            inner
        } else {
            self.symbol()?
        };
        Ok(match self.exponent() {
            Some(exponent) => base.power(exponent),
            None => base,
        })
    }

    fn symbol(&mut self) -> Result<Scale, String> {
        let letters = self.rest.find(|c: char| !c.is_alphabetic()).unwrap_or(self.rest.len());
        let first = self.rest.chars().next().map_or(0, char::len_utf8);
        let (symbol, rest) = self.rest.split_at(letters.max(first));
        self.rest = rest;
        let found = SYMBOLS.iter().find(|(name, _)| *name == symbol);
        found.map(|(_, scale)| *scale).ok_or_else(|| symbol.to_owned())
    }

    fn exponent(&mut self) -> Option<i32> {
        let unsigned = self.rest.strip_prefix('-').unwrap_or(self.rest);
        let digit = unsigned.chars().next()?.to_digit(10)?;
        let negative = unsigned.len() < self.rest.len();
        self.rest = &unsigned[1..];
        let exponent = i32::try_from(digit).ok()?;
        Some(if negative { -exponent } else { exponent })
    }

    fn eat(&mut self, c: char) -> bool {
        let stripped = self.rest.strip_prefix(c);
        self.rest = stripped.unwrap_or(self.rest);
        stripped.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn is(text: &str, dimension: Dimension, si: f64) {
        let scale = parse_unit(text).unwrap();
        assert_eq!(scale.dimension, dimension, "{text}");
        let error = (scale.to_si(1.0) - si).abs();
        assert!(error <= si.abs() * f64::EPSILON, "{text}: {} is not {si}", scale.to_si(1.0));
    }

    #[test]
    fn published_conversion_factors() {
        // NIST SP 811, appendix B.
        is("psi", Dimension::PRESSURE, 6_894.757_293_168_361);
        is("in", Dimension::LENGTH, 0.0254);
        is("lb", Dimension::MASS, 0.453_592_37);
        is("atm", Dimension::PRESSURE, 101_325.0);
        is("deg", Dimension::ANGLE, 0.017_453_292_519_943_295);
        // SMC states C in dm3/(s bar); ISO 6358 in m3/(s Pa): 1e-3 / 1e5.
        is("dm3/(s bar)", Dimension::SONIC_CONDUCTANCE, 1e-8);
    }

    #[test]
    fn products_quotients_and_powers() {
        is("g/cm3", Dimension::DENSITY, 1e3);
        is("kg m-3", Dimension::DENSITY, 1.0);
        is("N/mm2", Dimension::PRESSURE, 1e6);
        is("N/(m*m)", Dimension::PRESSURE, 1.0);
        is("NL/min", Dimension::VOLUME_FLOW, 1e-3 / 60.0);
        is("deg/s", Dimension::ANGULAR_SPEED, PI / 180.0);
        is("1/s", Dimension::FREQUENCY, 1.0);
        is("J/(s K)", Dimension::HEAT_CONDUCTANCE, 1.0);
    }

    #[test]
    fn other_spellings() {
        is("µm", Dimension::LENGTH, 1e-6);
        is("dm³/(s·bar)", Dimension::SONIC_CONDUCTANCE, 1e-8);
        is("m^3", Dimension::VOLUME, 1.0);
        is("°", Dimension::ANGLE, PI / 180.0);
    }

    #[test]
    fn only_a_lone_celsius_has_an_offset() {
        assert_eq!(parse_unit("°C").unwrap().to_si(20.0), 293.15);
        is("W/degC", Dimension::HEAT_CONDUCTANCE, 1.0);
    }

    #[test]
    fn what_is_not_a_unit_is_named() {
        for (text, part) in [("furlong", "furlong"), ("kg/mm)", ")"), ("", ""), ("m/", ""), ("(m", "("), ("m33", "3")] {
            assert_eq!(parse_unit(text).unwrap_err(), part, "{text}");
        }
        assert!(parse_unit(&"(".repeat(100_000)).is_err());
        assert!(parse_unit(&"m9".repeat(24)).is_ok(), "exponents add up without overflow");
    }

    #[test]
    fn symbols_are_unique() {
        for (i, (symbol, _)) in SYMBOLS.iter().enumerate() {
            assert!(SYMBOLS[..i].iter().all(|(earlier, _)| earlier != symbol), "{symbol}");
        }
    }
}
