//! The reference page of the schema.

use super::schema::{Integer, Key, Pair, Presence, SECTIONS, Section, Unit, parameter, study};

const INTRODUCTION: &str = "\
# Scene reference

A scene is a TOML file, format 1. This page is written from the schema that the reader checks by; a test keeps it so.

A value with a dimension is a number in SI units or a string with a unit: `inner_radius = 0.010` and `inner_radius = \"10 mm\"` are the same.
Units combine as in `\"1080 kg/m3\"` and `\"0.144 dm3/(s bar)\"`; a percentage is a plain number over 100. Pressures are gauge unless a key says absolute.
Air flows are volumes at the reference atmosphere of ISO 8778, so `NL` and `L` are the same. An unknown key is an error.
";

const STUDY_INTRODUCTION: &str = "\
# Study reference

A study is a TOML file, format 1, for `softlimb sweep` ([guide](../guide/sweep.md)). This page is written from the schema that the reader checks
by; a test keeps it so. Values are written as in a [scene](scene.md).
";

/// The page `docs/reference/study.md`, in Markdown: every key with its range and default.
pub fn study_reference() -> String {
    let sections = [study::SECTION, parameter::SECTION].map(|found| section(&found));
    format!("{STUDY_INTRODUCTION}\n{}", sections.join("\n"))
}

/// The page `docs/reference/scene.md`, in Markdown: every key with its range and default.
pub fn reference() -> String {
    let sections: Vec<String> = SECTIONS.iter().map(section).collect();
    format!("{INTRODUCTION}\n{}", sections.join("\n"))
}

fn section(section: &Section) -> String {
    let heading =
        if section.header.is_empty() { "Top of the file".to_owned() } else { format!("`{}`", section.header) };
    let rows: Vec<String> = section.keys.iter().map(row).collect();
    let doc = section.doc.trim();
    format!(
        "## {heading}\n\n{doc}\n\n| key | value | default | meaning |\n| --- | --- | --- | --- |\n{}\n",
        rows.join("\n")
    )
}

fn row(key: &Key) -> String {
    let (value, default, doc) = match key {
        Key::Quantity(key) => {
            let (min, max) = (key.unit.show(key.min), key.unit.show(key.max));
            (format!("{min} to {max}"), presence(key.presence, |value| key.unit.show(value)), key.doc)
        }
        Key::Vector(key) => {
            let value = match key.unit.symbol {
                "" => "three numbers".to_owned(),
                symbol => format!("three values in {symbol}, each within {}", Unit::show(&key.unit, key.max)),
            };
            (value, presence(key.presence, |v| format!("`[{}, {}, {}]`", v[0], v[1], v[2])), key.doc)
        }
        Key::Integer(key) => (integer_range(key), presence(key.presence, |value| value.to_string()), key.doc),
        Key::Choice(key) => {
            (format!("`{}`", key.words.join("`, `")), presence(key.presence, |word| format!("`{word}`")), key.doc)
        }
        Key::Text(key) => {
            let value = if key.is_name { "name" } else { "text" };
            let shown = |text: &str| if text.is_empty() { "empty".to_owned() } else { format!("`{text}`") };
            (value.to_owned(), presence(key.presence, shown), key.doc)
        }
        Key::Flag(key) => ("`true`, `false`".to_owned(), presence(key.presence, |on| format!("`{on}`")), key.doc),
        Key::Pair(key) => {
            let Pair { unit, min, max, .. } = key;
            let value = format!("two values, {} to {}", unit.show(*min), unit.show(*max));
            let shown = |[low, high]: [f64; 2]| format!("{} to {}", unit.show(low), unit.show(high));
            (value, presence(key.presence, shown), key.doc)
        }
        Key::Nested(key) => (key.shape.to_owned(), presence(key.presence, str::to_owned), key.doc),
    };
    format!("| `{}` | {value} | {default} | {doc} |", key.name())
}

fn integer_range(key: &Integer) -> String {
    match key.max {
        i64::MAX => format!("{} to 2^63-1", key.min),
        max if max == key.min => key.min.to_string(),
        max => format!("{} to {max}", key.min),
    }
}

fn presence<T>(presence: Presence<T>, show: impl FnOnce(T) -> String) -> String {
    match presence {
        Presence::Required => "required".to_owned(),
        Presence::Default(value) => show(value),
        Presence::Optional(text) => text.to_owned(),
    }
}
