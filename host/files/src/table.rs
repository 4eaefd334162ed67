//! Tables of numbers as text: commas, a header whose names carry the units, `#` for comments, empty cells for what was not measured.

use std::ops::RangeInclusive;

/// Most characters of a cell that a message repeats.
const REPEATED: usize = 40;

/// What is wrong with a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// There is no header, or no row below it.
    #[error("there is {0}: expected a header and at least one row of numbers below it")]
    Empty(&'static str),
    /// A row as a whole.
    #[error("line {line}: {problem}")]
    Line {
        /// From 1.
        line: usize,
        /// In words.
        problem: String,
    },
    /// One cell.
    #[error("line {line}, column `{column}`: {value} is not allowed: {allowed}")]
    Cell {
        /// From 1.
        line: usize,
        /// As in the header.
        column: String,
        /// As written, between backticks.
        value: String,
        /// What is accepted.
        allowed: String,
    },
}

/// A column that a table may have.
#[derive(Clone, Copy, Debug)]
pub struct Known<K> {
    /// Its name, with the unit.
    pub name: &'static str,
    /// What it holds.
    pub kind: K,
    /// Factor to SI units.
    pub factor: f64,
    /// Added after that.
    pub shift: f64,
    /// Values accepted, as written.
    pub range: [f64; 2],
}

/// A table cut into cells.
pub struct Table<'a> {
    line: usize,
    names: Vec<&'a str>,
    rows: Vec<Row<'a>>,
}

/// A row.
pub struct Row<'a> {
    /// Its line in the text, from 1.
    pub line: usize,
    cells: Vec<&'a str>,
}

impl<'a> Table<'a> {
    /// Cuts a text. Every row has as many cells as the header.
    pub fn cut(text: &'a str) -> Result<Self, TableError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let written = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
        let mut lines = written.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (line, header) = lines.next().ok_or(TableError::Empty("nothing"))?;
        let cells = |line: &'a str| line.split(',').map(|cell| cell.trim().trim_matches('"')).collect::<Vec<_>>();
        let names = cells(header);
        if names.len() == 1 && header.contains([';', '\t']) {
            let problem = "separate the columns by commas, and write numbers with a point".into();
            return Err(TableError::Line { line, problem });
        }
        if let Some(twice) = names.iter().enumerate().find_map(|(k, name)| names[..k].contains(name).then_some(name)) {
            return Err(TableError::Line { line, problem: format!("there are two columns {}", quoted(twice)) });
        }
        let rows: Vec<Row<'a>> = lines.map(|(line, text)| Row { line, cells: cells(text) }).collect();
        if rows.is_empty() {
            return Err(TableError::Empty("a header alone"));
        }
        match rows.iter().find(|row| row.cells.len() != names.len()) {
            Some(Row { line, cells }) => {
                let problem = format!("{} cells where the header has {}", cells.len(), names.len());
                Err(TableError::Line { line: *line, problem })
            }
            None => Ok(Self { line, names, rows }),
        }
    }

    /// Its rows.
    pub fn rows(&self) -> &[Row<'a>] {
        &self.rows
    }

    /// Refuses columns that are neither known nor one of `others`.
    pub fn only<K>(&self, known: &[Known<K>], others: &[&str]) -> Result<(), TableError> {
        let expected = || known.iter().map(|column| column.name).chain(others.iter().copied());
        match self.names.iter().find(|name| !expected().any(|other| other == **name)) {
            Some(name) => {
                let known: Vec<_> = expected().collect();
                let problem = format!("unknown column {}; known are {}", quoted(name), known.join(", "));
                Err(TableError::Line { line: self.line, problem })
            }
            None => Ok(()),
        }
    }

    /// The known columns that are there, each with its place.
    pub fn columns<'k, K>(&self, known: &'k [Known<K>]) -> Vec<(usize, &'k Known<K>)> {
        let place = |column: &'k Known<K>| Some((self.place(column.name)?, column));
        known.iter().filter_map(place).collect()
    }

    /// The place of a column.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|other| *other == name)
    }

    /// A complaint about the header.
    pub fn header_error(&self, problem: String) -> TableError {
        TableError::Line { line: self.line, problem }
    }
}

impl Row<'_> {
    /// A cell as it is written.
    pub fn text(&self, place: usize) -> &str {
        self.cells[place]
    }

    /// A number in SI units; `None` for an empty cell.
    pub fn number<K>(&self, place: usize, column: &Known<K>) -> Result<Option<f64>, TableError> {
        let written = self.written(place, column.name, column.range)?;
        Ok(written.map(|value| value * column.factor + column.shift))
    }

    /// A number as it is written; `None` for an empty cell.
    pub fn written(&self, place: usize, column: &str, [low, high]: [f64; 2]) -> Result<Option<f64>, TableError> {
        let text = self.cells[place];
        if text.is_empty() {
            return Ok(None);
        }
        let accepted: RangeInclusive<f64> = low..=high;
        match text.parse::<f64>() {
            Ok(value) if accepted.contains(&value) => Ok(Some(value)),
            _ => Err(self.refused(place, column, format!("a number from {low} to {high}"))),
        }
    }

    /// A complaint about a cell.
    pub fn refused(&self, place: usize, column: &str, allowed: String) -> TableError {
        let column = column.to_owned();
        TableError::Cell { line: self.line, column, value: quoted(self.cells[place]), allowed }
    }
}

/// A piece of the user's text between backticks, on one line and not too long.
fn quoted(text: &str) -> String {
    let mut short: String = text.chars().take(REPEATED).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > REPEATED {
        short.push_str("...");
    }
    format!("`{short}`")
}
