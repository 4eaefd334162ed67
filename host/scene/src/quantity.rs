//! Numbers with a unit, as a user writes them: `"6.5 mm"`.

use std::fmt;

use super::unit::{Scale, parse_unit};

/// A quantity outside a scene, such as an option of a command; displayed as typed.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    si: f64,
    scale: Scale,
    unit: String,
    text: String,
}

/// Reads `"6.5 mm"`, or a plain number in `unit`; the quantity has the dimension of `unit`.
///
/// # Errors
/// The rule that the text breaks.
///
/// # Panics
/// If `unit` is not a unit of scenes.
pub fn quantity(text: &str, unit: &str) -> Result<Quantity, String> {
    let default = parse_unit(unit).expect("a unit of scenes");
    let wanted = default.dimension.name();
    let text = text.trim();
    let (value, scale, typed) = match parse_quantity(text) {
        Ok((value, scale)) => (value, scale, text[number_length(text)..].trim()),
        Err(NotAQuantity::UnitMissing) => (text.replace('_', "").parse().unwrap_or(f64::NAN), default, unit),
        Err(NotAQuantity::UnitUnknown(part)) => return Err(format!("`{part}` is not a unit")),
        Err(NotAQuantity::Number) => return Err(format!("{wanted} starts with a finite number")),
    };
    if scale.dimension != default.dimension {
        return Err(format!("this is {}: give {wanted}, in {unit} for example", scale.dimension.name()));
    }
    let si = scale.to_si(value);
    let unit = if typed == "1" { String::new() } else { typed.to_owned() };
    if si.is_finite() { Ok(Quantity { si, scale, unit, text: text.to_owned() }) } else { Err("too large".to_owned()) }
}

impl Quantity {
    /// The value in SI units.
    pub fn si(&self) -> f64 {
        self.si
    }

    /// An SI value in the unit of this quantity.
    pub fn shown(&self, si: f64) -> String {
        let number = show_number(self.scale.of_si(si));
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Why a text is not a quantity.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NotAQuantity {
    /// It does not start with a finite number.
    Number,
    /// It is a number and nothing else.
    UnitMissing,
    /// This part of the unit is not known.
    UnitUnknown(String),
}

/// Splits `"6.5 mm"` into the number and its unit.
pub(super) fn parse_quantity(text: &str) -> Result<(f64, Scale), NotAQuantity> {
    let (number, unit) = split_quantity(text);
    let value = number.replace('_', "").parse::<f64>().map_err(|_| NotAQuantity::Number)?;
    if !value.is_finite() {
        return Err(NotAQuantity::Number);
    }
    if unit.is_empty() {
        return Err(NotAQuantity::UnitMissing);
    }
    let scale = parse_unit(unit).map_err(NotAQuantity::UnitUnknown)?;
    Ok((value, scale))
}

/// Number and unit of a quantity.
pub(super) fn split_quantity(text: &str) -> (&str, &str) {
    let text = text.trim();
    let (number, unit) = text.split_at(number_length(text));
    (number, unit.trim())
}

/// Length of the decimal number a text starts with; an `e` counts only when an exponent follows it.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| {
        let rest = text.get(from..).unwrap_or("");
        rest.bytes().take_while(|b| b.is_ascii_digit() || *b == b'_').count()
    };
    let sign = |at: usize| usize::from(text.get(at..).is_some_and(|rest| rest.starts_with(['+', '-'])));
    let mut end = sign(0);
    end += digits(end);
    if text[end..].starts_with('.') {
        end += 1 + digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let exponent = end + 1 + sign(end + 1);
        if digits(exponent) > 0 {
            end = exponent + digits(exponent);
        }
    }
    end
}

/// A number for a message: six significant digits, no trailing zeros, powers of ten only where they help.
pub(super) fn show_number(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse::<f64>().unwrap_or(value);
    let magnitude = rounded.abs();
    if magnitude != 0.0 && !(1e-4..1e7).contains(&magnitude) { format!("{rounded:e}") } else { format!("{rounded}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_units_are_split() {
        for (text, si) in [
            ("6.5 mm", 0.0065),
            ("  240mm ", 0.24),
            ("1e3 Pa", 1000.0),
            ("1E-2m", 0.01),
            ("-.5 kPa", -500.0),
            ("1_000 g", 1.0),
            ("3 %", 0.03),
            ("0.1 1/s", 0.1),
        ] {
            let (value, scale) = parse_quantity(text).unwrap();
            assert_eq!(scale.to_si(value), si, "{text}");
        }
    }

    #[test]
    fn option_is_read_in_its_own_unit_and_shown_in_the_one_typed() {
        for (text, si, shown) in [("60", 60e3, "50 kPa"), ("0.6bar", 60e3, "0.5 bar"), ("-1 MPa", -1e6, "0.05 MPa")] {
            let found = quantity(text, "kPa").unwrap();
            assert!((found.si() - si).abs() < 1e-9, "{text}");
            assert_eq!((found.shown(50e3).as_str(), found.to_string().as_str()), (shown, text));
        }
        assert_eq!(quantity("5 %", "1").unwrap().si(), 0.05);
        assert_eq!(quantity("0.05", "1").unwrap().shown(0.5), "0.5");
        for (text, words) in [
            ("3 mm", "this is a length: give a pressure, in kPa for example"),
            ("1 furlong", "`furlong` is not a unit"),
            ("x", "a pressure starts with a finite number"),
            ("NaN", "a pressure starts with a finite number"),
            ("1e308 GPa", "too large"),
        ] {
            assert_eq!(quantity(text, "kPa").unwrap_err(), words, "{text}");
        }
    }

    #[test]
    fn malformed_quantities() {
        for text in ["", "mm", "inf m", "NaN Pa", "1e999 m", "--1 m", ". m", "½ m"] {
            assert_eq!(parse_quantity(text), Err(NotAQuantity::Number), "{text}");
        }
        assert_eq!(parse_quantity("15"), Err(NotAQuantity::UnitMissing));
        assert_eq!(parse_quantity("1 e"), Err(NotAQuantity::UnitUnknown("e".into())));
    }

    #[test]
    fn numbers_are_shown_short() {
        for (value, text) in [(0.1 + 0.2, "0.3"), (240.0, "240"), (1e-13, "1e-13"), (0.0, "0"), (-2.5e9, "-2.5e9")] {
            assert_eq!(show_number(value), text);
        }
    }
}
