//! Values of a parameter.

use toml::de::DeValue;
use toml_edit::Value;

use crate::quantity::{parse_quantity, split_quantity};

/// A value, as TOML of the scene and as text of the table.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub(super) written: Value,
    pub(super) shown: String,
}

/// Values of a parameter. The unit is empty for values without one.
#[derive(Clone, Debug)]
pub(super) enum Values {
    Listed { settings: Vec<Setting>, unit: String },
    Range { ends: [f64; 2], unit: String },
}

impl Values {
    /// Number of listed values; `None` for a range.
    pub(super) fn listed(&self) -> Option<u64> {
        match self {
            Self::Listed { settings, .. } => Some(settings.len() as u64),
            Self::Range { .. } => None,
        }
    }

    pub(super) fn unit(&self) -> &str {
        match self {
            Self::Listed { unit, .. } | Self::Range { unit, .. } => unit,
        }
    }

    /// The first listed value, or the lower end of the range.
    pub(super) fn first(&self) -> Setting {
        match self {
            Self::Listed { settings, .. } => settings[0].clone(),
            Self::Range { ends: [low, _], unit } => quantity(*low, unit),
        }
    }
}

/// A drawn value.
pub(super) fn quantity(number: f64, unit: &str) -> Setting {
    // Nine significant digits exceed any tolerance of fabrication.
    let number = format!("{number:.8e}").parse().unwrap_or(number);
    let shown = format!("{number}");
    let written = if unit.is_empty() { Value::from(number) } else { Value::from(format!("{number} {unit}")) };
    Setting { written, shown }
}

/// A value and its unit; the error names the allowed types.
pub(super) fn setting(value: &DeValue<'_>) -> Result<(Setting, String), &'static str> {
    let plain = |written: Value, shown: String| Ok((Setting { written, shown }, String::new()));
    match value {
        DeValue::String(text) => match parse_quantity(text) {
            Ok(_) => {
                let (number, unit) = split_quantity(text);
                let setting = Setting { written: Value::from(text.as_ref()), shown: number.to_owned() };
                Ok((setting, unit.to_owned()))
            }
            Err(_) => plain(Value::from(text.as_ref()), text.to_string()),
        },
        DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(number) => plain(Value::from(number), number.to_string()),
            Err(_) => Err("a whole number below 2^63"),
        },
        DeValue::Float(float) => match float.as_str().parse::<f64>() {
            Ok(number) if number.is_finite() => plain(Value::from(number), number.to_string()),
            _ => Err("a finite number"),
        },
        DeValue::Boolean(flag) => plain(Value::from(*flag), flag.to_string()),
        _ => Err("a number, a text with a unit, a word, or `true` or `false`"),
    }
}

/// End of a range and its unit; the error names the allowed types.
pub(super) fn end(value: &DeValue<'_>) -> Result<(f64, String), &'static str> {
    let must = "a number or a text with a unit";
    let (found, unit) = setting(value)?;
    let number = found.shown.replace('_', "").parse::<f64>().map_err(|_| must)?;
    Ok((number, unit))
}
