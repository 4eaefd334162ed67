//! Units: a small grammar over a table of symbols, with factors kept as exact fractions.
//!
//! ```text
//! unit   = factor { [ " " | "*" | "/" ] factor }        "/" divides by the one factor after it
//! factor = ( symbol | "(" unit ")" ) [ [ "-" ] digit ]
//! ```

mod scale;
mod symbols;

pub(super) use scale::{Dimension, Scale};
use symbols::SYMBOLS;
pub(super) use symbols::{symbols, symbols_of};

/// Longest unit text that is looked at, in bytes; bounds the recursion over parentheses.
const LONGEST: usize = 48;

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
    use std::f64::consts::PI;

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
    fn units_have_other_spellings() {
        is("µm", Dimension::LENGTH, 1e-6);
        is("dm³/(s·bar)", Dimension::SONIC_CONDUCTANCE, 1e-8);
        is("m^3", Dimension::VOLUME, 1.0);
        is("°", Dimension::ANGLE, PI / 180.0);
    }

    #[test]
    fn celsius_has_an_offset_only_alone() {
        assert_eq!(parse_unit("°C").unwrap().to_si(20.0), 293.15);
        is("W/degC", Dimension::HEAT_CONDUCTANCE, 1.0);
    }

    #[test]
    fn unknown_units_are_named() {
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
