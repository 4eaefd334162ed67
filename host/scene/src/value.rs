//! Reads single values: numbers with units, arrays of three, names.

use toml::de::DeValue;

use super::error::{Problem, quoted};
use super::quantity::{NotAQuantity, parse_quantity, show_number};
use super::reader::{Log, Value};
use super::schema::{Integer, Unit};
use super::source::{Located, Span};
use super::suggest::closest;
use super::unit;

/// A letter, then letters, digits, `-` or `_`; at most 32 in all.
pub(super) fn is_name(text: &str) -> bool {
    let tail = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.len() <= 32 && text.chars().all(tail)
}

/// The problem of a text that is no name.
pub(super) fn bad_name(span: Span, text: &str) -> Problem {
    let rule = "a name is a letter, then letters, digits, `-` or `_`, at most 32 in all";
    Problem::at(span, format!("{} is not a name", quoted(text)), "not a name").help(rule)
}

/// The three values of an array.
pub(super) fn triple<'a>(log: &Log, value: &'a Value<'a>, name: &str) -> Option<[&'a Value<'a>; 3]> {
    let DeValue::Array(items) = value.get_ref() else {
        return log.note(wrong_type(value.span().into(), &quoted(name), "an array of three values", value.get_ref()));
    };
    let items: Vec<_> = items.iter().collect();
    let count = items.len();
    <[_; 3]>::try_from(items).ok().or_else(|| {
        let title = format!("{} needs three values", quoted(name));
        log.note(Problem::at(value.span().into(), title, format!("this array has {count}")))
    })
}

/// The two values of an array.
pub(super) fn pair<'a>(log: &Log, value: &'a Value<'a>, name: &str) -> Option<[&'a Value<'a>; 2]> {
    let items: Vec<_> = match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        other => return log.note(wrong_type(value.span().into(), &quoted(name), "an array of two values", other)),
    };
    let count = items.len();
    <[_; 2]>::try_from(items).ok().or_else(|| {
        let title = format!("{} needs two values, the lower first", quoted(name));
        log.note(Problem::at(value.span().into(), title, format!("this array has {count}")))
    })
}

/// A number or a text with a unit as an SI value between two bounds, which are in `unit`.
pub(super) fn number_in(
    log: &Log,
    value: &Value<'_>,
    name: &str,
    unit: &Unit,
    min: f64,
    max: f64,
) -> Option<Located<f64>> {
    let span = value.span().into();
    let (si, bare) = match si_value(value, name, unit) {
        Ok(found) => found,
        Err(problem) => return log.note(problem),
    };
    if (unit.scale.to_si(min)..=unit.scale.to_si(max)).contains(&si) {
        return Some(Located { value: si, span });
    }
    let title = format!("`{name}` must be from {} to {}", unit.show(min), unit.show(max));
    if !bare || unit.si.is_empty() {
        return log.note(Problem::at(span, title, format!("this is {}", unit.show_si(si))));
    }
    let problem = Problem::at(span, title, format!("this is {} {}", show_number(si), unit.si));
    let meant = if (min..=max).contains(&si) && unit.symbol != unit.si {
        Some(unit.show(si))
    } else {
        in_thousandths(si, unit, min, max)
    };
    log.note(match meant {
        Some(meant) => problem.help(format!("a number without a unit is in {}; write \"{meant}\"?", unit.si)),
        None => problem,
    })
}

/// A plain number that was meant in mm or g, with that unit; `None` where that is not allowed either.
fn in_thousandths(number: f64, unit: &Unit, min: f64, max: f64) -> Option<String> {
    let (_, symbol) = [("m", "mm"), ("kg", "g")].into_iter().find(|(si, _)| *si == unit.si)?;
    let allowed = unit.scale.to_si(min)..=unit.scale.to_si(max);
    allowed.contains(&(1e-3 * number)).then(|| format!("{} {symbol}", show_number(number)))
}

/// The value in SI units, and whether it was written without a unit.
fn si_value(value: &Value<'_>, name: &str, unit: &Unit) -> Result<(f64, bool), Problem> {
    let span = value.span().into();
    let name = quoted(name);
    let wanted = unit.scale.dimension.name();
    let number = match value.get_ref() {
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|exact| exact as f64)
        }
        DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
        DeValue::String(text) => return quantity_in(text, span, &name, unit).map(|si| (si, false)),
        other => {
            let expected = format!("{wanted}: a number or a string with a unit");
            return Err(wrong_type(span, &name, &expected, other));
        }
    };
    match number {
        Some(number) if number.is_finite() => Ok((number, true)),
        _ => Err(Problem::at(span, format!("{name} needs {wanted}"), "not a finite number")),
    }
}

fn quantity_in(text: &str, span: Span, name: &str, unit: &Unit) -> Result<f64, Problem> {
    let wanted = unit.scale.dimension.name();
    let title = format!("{name} needs {wanted}");
    let (value, scale) = parse_quantity(text).map_err(|why| match why {
        NotAQuantity::Number => {
            Problem::at(span, title.clone(), "does not start with a finite number").help(units_help(unit))
        }
        NotAQuantity::UnitMissing if unit.symbol.is_empty() => {
            Problem::at(span, title.clone(), "a string needs a unit").help(units_help(unit))
        }
        NotAQuantity::UnitMissing => {
            let help = format!("write \"{} {}\"? {}", text.trim(), unit.symbol, units_help(unit));
            Problem::at(span, title.clone(), "a string needs a unit").help(help)
        }
        NotAQuantity::UnitUnknown(part) if part.starts_with(',') => {
            let help = format!("write a point, not a comma: \"{}\"", text.trim().replacen(',', ".", 1));
            Problem::at(span, title.clone(), "a decimal comma").help(help)
        }
        NotAQuantity::UnitUnknown(part) => {
            let meant =
                closest(&part, unit::symbols_of(unit.scale.dimension)).or_else(|| closest(&part, unit::symbols()));
            let help = meant.map_or_else(|| units_help(unit), |symbol| format!("did you mean `{symbol}`?"));
            Problem::at(span, format!("unknown unit {} of {name}", quoted(&part)), "unknown unit").help(help)
        }
    })?;
    if scale.dimension != unit.scale.dimension {
        let label = format!("this is {}", scale.dimension.name());
        return Err(Problem::at(span, title, label).help(units_help(unit)));
    }
    let si = scale.to_si(value);
    if si.is_finite() { Ok(si) } else { Err(Problem::at(span, title, "too large")) }
}

fn units_help(unit: &Unit) -> String {
    let dimension = unit.scale.dimension;
    let known: Vec<_> = unit::symbols_of(dimension).filter(|symbol| *symbol != "1").collect();
    let name = dimension.name();
    match (unit.symbol, known.as_slice()) {
        ("", _) => "write a number without quotes, or a percentage such as \"5 %\"".to_owned(),
        (symbol, []) => format!("write {name} in a unit such as `{symbol}`"),
        (_, known) => format!("units of {name}: {}", known.join(", ")),
    }
}

/// The allowed range in words.
pub(super) fn integer_range(key: &Integer) -> String {
    match key.max {
        i64::MAX => format!("a whole number from {} to 2^63-1", key.min),
        max => format!("a whole number from {} to {max}", key.min),
    }
}

/// The problem of a value of another type.
pub(super) fn wrong_type(span: Span, what: &str, expected: &str, found: &DeValue<'_>) -> Problem {
    let found = match found {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a boolean",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    };
    Problem::at(span, format!("{what} must be {expected}"), format!("this is {found}"))
}
