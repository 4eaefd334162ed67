//! Reads the values of one table by the schema, and notes every problem it meets.

use std::cell::RefCell;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{Problem, quoted};
use super::schema::{Choice, Flag, Integer, Key, Nested, Pair, Presence, Quantity, Section, Text, Vector};
use super::source::{Located, Span};
use super::suggest::closest;
use super::value::{bad_name, integer_range, is_name, number_in, pair, triple, wrong_type};

/// A value of the scene and its place.
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// The problems met so far.
#[derive(Default)]
pub(super) struct Log {
    problems: RefCell<Vec<Problem>>,
}

impl Log {
    /// Notes a problem; the `None` stands for the value that is not there.
    pub(super) fn note<T>(&self, problem: Problem) -> Option<T> {
        self.problems.borrow_mut().push(problem);
        None
    }

    pub(super) fn into_problems(self) -> Vec<Problem> {
        self.problems.into_inner()
    }
}

/// One table of the scene and the section of the schema it must follow.
///
/// Every method gives `None` after it has noted a problem, so that a caller can read all keys before it gives up.
pub(super) struct Reader<'a> {
    log: &'a Log,
    table: &'a DeTable<'a>,
    section: &'static Section,
    span: Span,
    /// Keys that are misspelled here; that they are missing is no second problem.
    misspelled: Vec<&'static str>,
}

impl<'a> Reader<'a> {
    /// Starts on a table and notes its unknown keys. `span` is its header; the top of the file is [`Span::NOWHERE`].
    pub(super) fn new(log: &'a Log, table: &'a DeTable<'a>, section: &'static Section, span: Span) -> Self {
        let mut reader = Self { log, table, section, span, misspelled: Vec::new() };
        let known = || section.keys.iter().map(Key::name);
        for (key, _) in table.iter() {
            let written = key.get_ref().as_ref();
            if known().any(|name| name == written) {
                continue;
            }
            let meant = closest(written, known().filter(|name| !table.contains_key(*name)));
            let help = match meant {
                Some(name) => format!("did you mean `{name}`?"),
                None => format!("known keys: {}", known().collect::<Vec<_>>().join(", ")),
            };
            reader.misspelled.extend(meant);
            let title = format!("unknown key {}{}", quoted(written), reader.place());
            log.note::<()>(Problem::at(key.span().into(), title, "unknown key").help(help));
        }
        reader
    }

    /// A sub-table read from a value that must be one.
    pub(super) fn open(log: &'a Log, value: &'a Value<'a>, section: &'static Section, what: &str) -> Option<Self> {
        match value.get_ref() {
            DeValue::Table(table) => Some(Self::new(log, table, section, value.span().into())),
            other => log.note(wrong_type(value.span().into(), what, "a table", other)),
        }
    }

    /// The table that is left out here: every key has its default.
    pub(super) fn absent(&self, section: &'static Section) -> Self {
        static EMPTY: std::sync::LazyLock<DeTable<'static>> = std::sync::LazyLock::new(DeTable::new);
        Self { log: self.log, table: &EMPTY, section, span: Span::NOWHERE, misspelled: Vec::new() }
    }

    /// Place of problems of the whole table: its header.
    pub(super) fn span(&self) -> Span {
        self.span
    }

    pub(super) fn log(&self) -> &'a Log {
        self.log
    }

    /// The value of a key and its place, if it is written.
    pub(super) fn value(&self, name: &str) -> Option<&'a Value<'a>> {
        self.table.get(name)
    }

    /// The place of a key, if it is written.
    pub(super) fn key_span(&self, name: &str) -> Option<Span> {
        self.table.get_key_value(name).map(|(key, _)| key.span().into())
    }

    /// The place of a value deep inside this table, [`Span::NOWHERE`] if it is not written.
    pub(super) fn place_of(&self, table: &str, path: &[&str]) -> Span {
        let first = self.value(table);
        let found = path.iter().fold(first, |value, name| value?.get_ref().as_table()?.get(*name));
        found.map_or(Span::NOWHERE, |value| value.span().into())
    }

    /// Notes that a required key is missing.
    pub(super) fn missing<T>(&self, name: &str, because: &str) -> Option<T> {
        if self.misspelled.contains(&name) {
            return None;
        }
        let title = format!("missing key `{name}`{}", self.place());
        self.log.note(match self.section.header {
            "" => Problem::new(title),
            _ => Problem::at(self.span, title, format!("`{name}` is required{because}")),
        })
    }

    /// Notes that a table of the top level is missing.
    pub(super) fn no_table<T>(&self, name: &str, header: &str, help: &str) -> Option<T> {
        if self.misspelled.contains(&name) {
            return None;
        }
        self.log.note(Problem::new(format!("the scene has no `{header}`")).help(help))
    }

    /// Notes a key that has no meaning here.
    pub(super) fn forbid(&self, names: &[&str], because: &str) -> Option<()> {
        let written: Vec<_> = names.iter().filter_map(|name| Some((name, self.key_span(name)?))).collect();
        for (name, span) in &written {
            let title = format!("`{name}` has no meaning {because}");
            self.log.note::<()>(Problem::at(*span, title, "remove this key"));
        }
        written.is_empty().then_some(())
    }

    /// A quantity that is required or has a default, in SI units.
    pub(super) fn quantity(&self, key: &Quantity) -> Option<Located<f64>> {
        match (self.maybe(key)?, key.presence) {
            (Some(found), _) => Some(found),
            (None, Presence::Default(value)) => Some(Located { value: key.unit.scale.to_si(value), span: self.span() }),
            (None, _) => self.missing(key.name, ""),
        }
    }

    /// A quantity that may be left out, in SI units. The outer `None` is a noted problem.
    pub(super) fn maybe(&self, key: &Quantity) -> Option<Option<Located<f64>>> {
        let Some(value) = self.value(key.name) else { return Some(None) };
        number_in(self.log, value, key.name, &key.unit, key.min, key.max).map(Some)
    }

    /// Three components in SI units; `None` inside if they may be left out and are.
    pub(super) fn vector(&self, key: &Vector) -> Option<Option<Located<[f64; 3]>>> {
        let Some(value) = self.value(key.name) else {
            return match key.presence {
                Presence::Default(default) => Some(Some(Located { value: default, span: self.span() })),
                Presence::Optional(_) => Some(None),
                Presence::Required => self.missing(key.name, ""),
            };
        };
        let components = triple(self.log, value, key.name)?;
        let read = |value| number_in(self.log, value, key.name, &key.unit, -key.max, key.max).map(|found| *found);
        let [x, y, z] = components.map(read);
        Some(Some(Located { value: [x?, y?, z?], span: value.span().into() }))
    }

    /// A whole number.
    pub(super) fn integer(&self, key: &Integer) -> Option<Located<i64>> {
        let Some(value) = self.value(key.name) else {
            return match key.presence {
                Presence::Default(default) => Some(Located { value: default, span: self.span() }),
                _ => self.missing(key.name, ""),
            };
        };
        let span = value.span().into();
        let DeValue::Integer(integer) = value.get_ref() else {
            return self.log.note(wrong_type(span, &quoted(key.name), "a whole number", value.get_ref()));
        };
        match i64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(found) if (key.min..=key.max).contains(&found) => Some(Located { value: found, span }),
            _ => {
                let title = format!("`{}` must be {}", key.name, integer_range(key));
                self.log.note(Problem::at(span, title, "out of range"))
            }
        }
    }

    /// One of `values`, by the word at the same place in the key's list.
    pub(super) fn choice<T: Copy>(&self, key: &Choice, values: &[T]) -> Option<Located<T>> {
        let (word, span) = match (self.value(key.name), key.presence) {
            (Some(value), _) => (self.string(value, key.name)?, value.span().into()),
            (None, Presence::Default(word)) => (word, self.span()),
            (None, _) => return self.missing(key.name, ""),
        };
        let known = key.words.iter().zip(values).find(|(known, _)| **known == word);
        if let Some((_, found)) = known {
            return Some(Located { value: *found, span });
        }
        let words = key.words.join("`, `");
        let help = match closest(word, key.words.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("choose one of `{words}`"),
        };
        let title = format!("unknown `{}` {}", key.name, quoted(word));
        self.log.note(Problem::at(span, title, format!("not one of `{words}`")).help(help))
    }

    /// One of `values`, or `None` inside if it is left out.
    pub(super) fn maybe_choice<T: Copy>(&self, key: &Choice, values: &[T]) -> Option<Option<Located<T>>> {
        self.value(key.name).map_or(Some(None), |_| self.choice(key, values).map(Some))
    }

    /// Yes or no.
    pub(super) fn flag(&self, key: &Flag) -> Option<bool> {
        match (self.value(key.name), key.presence) {
            (Some(value), _) => match value.get_ref() {
                DeValue::Boolean(found) => Some(*found),
                other => self.log.note(wrong_type(value.span().into(), &quoted(key.name), "`true` or `false`", other)),
            },
            (None, Presence::Default(value)) => Some(value),
            (None, _) => self.missing(key.name, ""),
        }
    }

    /// Yes or no; `None` inside if it is left out.
    pub(super) fn maybe_flag(&self, key: &Flag) -> Option<Option<bool>> {
        self.value(key.name).map_or(Some(None), |_| self.flag(key).map(Some))
    }

    /// A lower and an upper value in SI units; `None` inside if they are left out.
    pub(super) fn pair(&self, key: &Pair) -> Option<Option<Located<[f64; 2]>>> {
        let Some(value) = self.value(key.name) else { return Some(None) };
        let span = value.span().into();
        let read = |value| number_in(self.log, value, key.name, &key.unit, key.min, key.max).map(|found| *found);
        let [low, high] = pair(self.log, value, key.name)?.map(read);
        let (low, high) = (low?, high?);
        if low <= high {
            return Some(Some(Located { value: [low, high], span }));
        }
        let title = format!("{} needs the lower value first", quoted(key.name));
        self.log.note(Problem::at(span, title, "the first is above the second"))
    }

    /// A text; `None` inside if it may be left out and is.
    pub(super) fn maybe_text(&self, key: &Text) -> Option<Option<Located<&'a str>>> {
        let Some(value) = self.value(key.name) else {
            return match key.presence {
                Presence::Default(text) => Some(Some(Located { value: text, span: self.span() })),
                Presence::Optional(_) => Some(None),
                Presence::Required => self.missing(key.name, ""),
            };
        };
        let span = value.span().into();
        let text = self.string(value, key.name)?;
        if key.is_name && !is_name(text) {
            return self.log.note(bad_name(span, text));
        }
        Some(Some(Located { value: text, span }))
    }

    /// A text that is required or has a default.
    pub(super) fn text(&self, key: &Text) -> Option<Located<&'a str>> {
        self.maybe_text(key)?.or_else(|| self.missing(key.name, ""))
    }

    /// A name, or an array of two; `None` inside if it is left out.
    pub(super) fn one_or_two_names(&self, key: &Text) -> Option<Option<Vec<Located<&'a str>>>> {
        let Some(DeValue::Array(items)) = self.value(key.name).map(Spanned::get_ref) else {
            return self.maybe_text(key).map(|name| name.map(|name| vec![name]));
        };
        if items.len() != 2 {
            let span = self.value(key.name).map_or(self.span, |value| value.span().into());
            let title = format!("{} needs a name or an array of two", quoted(key.name));
            return self.log.note(Problem::at(span, title, format!("this array has {}", items.len())));
        }
        let name = |item| {
            let span = Spanned::span(item).into();
            let text = self.string(item, key.name)?;
            if is_name(text) { Some(Located { value: text, span }) } else { self.log.note(bad_name(span, text)) }
        };
        let names: Vec<_> = items.iter().filter_map(name).collect();
        (names.len() == 2).then_some(Some(names))
    }

    /// The tables of an array of tables.
    pub(super) fn tables(&self, key: &Nested, section: &'static Section) -> Option<Vec<Reader<'a>>> {
        let Some(value) = self.value(key.name) else {
            return self.no_table(key.name, section.header, "add at least one");
        };
        let DeValue::Array(items) = value.get_ref() else {
            let expected = format!("an array of tables, each with the header `{}`", section.header);
            return self.log.note(wrong_type(value.span().into(), &quoted(key.name), &expected, value.get_ref()));
        };
        if items.is_empty() {
            return self.no_table(key.name, section.header, "add at least one");
        }
        items.iter().map(|item| Self::open(self.log, item, section, section.header)).collect()
    }

    /// The tables of an array of tables that may be left out, at most `most`.
    pub(super) fn maybe_tables(&self, key: &Nested, section: &'static Section, most: usize) -> Option<Vec<Reader<'a>>> {
        if self.value(key.name).is_none() {
            return Some(Vec::new());
        }
        let tables = self.tables(key, section)?;
        match tables.get(most) {
            None => Some(tables),
            Some(extra) => {
                let title = format!("too many tables `{}`", section.header);
                self.log.note(Problem::at(extra.span, title, format!("a scene has at most {most}")))
            }
        }
    }

    fn string(&self, value: &'a Value<'a>, name: &str) -> Option<&'a str> {
        match value.get_ref() {
            DeValue::String(text) => Some(text.as_ref()),
            other => self.log.note(wrong_type(value.span().into(), &quoted(name), "a string", other)),
        }
    }

    fn place(&self) -> String {
        let header = self.section.header;
        if header.is_empty() { String::new() } else { format!(" in `{header}`") }
    }
}
