//! Tables of numbers as text: commas, a header whose names carry the units, `#` for comments, empty cells for what was not measured.

use std::ops::RangeInclusive;

use csv::{ReaderBuilder, StringRecord, Trim, Writer};

/// Most characters of a cell that a message repeats.
const REPEATED: usize = 40;

/// Error of a table.
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
        /// Accepted values.
        allowed: String,
    },
}

/// A column that a table may have.
#[derive(Clone, Copy, Debug)]
pub struct Known<K> {
    /// Its name, with the unit.
    pub name: &'static str,
    /// Its content.
    pub kind: K,
    /// Factor to SI units.
    pub factor: f64,
    /// Added after that.
    pub shift: f64,
    /// Values accepted, as written.
    pub range: [f64; 2],
}

/// A table cut into cells.
pub struct Table {
    line: usize,
    names: StringRecord,
    rows: Vec<Row>,
}

/// A row.
pub struct Row {
    /// Its line in the text, from 1.
    pub line: usize,
    cells: StringRecord,
}

/// The rows of a text, its header among them. Blank lines and comments are left out; cells are without the blanks and quotes around them.
///
/// # Errors
/// [`TableError::Line`].
pub fn rows(text: &str) -> Result<Vec<Row>, TableError> {
    // To the parser a blank is part of a line, and a comment begins at the first character.
    let text: Vec<&str> = text.strip_prefix('\u{feff}').unwrap_or(text).lines().map(str::trim).collect();
    let text = text.join("\n");
    let mut how = ReaderBuilder::new();
    how.has_headers(false).flexible(true).comment(Some(b'#')).trim(Trim::All);
    let (mut reader, mut rows) = (how.from_reader(text.as_bytes()), Vec::new());
    loop {
        let (mut cells, begin) = (StringRecord::new(), reader.position().clone());
        let skipped = text[begin.byte() as usize..].lines().take_while(|line| line.is_empty() || line.starts_with('#'));
        let line = begin.line() as usize + skipped.count();
        match reader.read_record(&mut cells) {
            // Quotes behind a blank are no quotes to the parser.
            Ok(true) => rows.push(Row { line, cells: cells.iter().map(|cell| cell.trim_matches('"')).collect() }),
            Ok(false) => return Ok(rows),
            Err(error) => return Err(TableError::Line { line, problem: error.to_string() }),
        }
    }
}

/// A text of a header and rows, with quotes where a cell needs them.
pub fn written<C: AsRef<[u8]>, R: IntoIterator<Item = C>>(
    header: &[&str],
    rows: impl IntoIterator<Item = R>,
) -> String {
    let mut writer = Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    let _ = writer.write_record(header);
    for row in rows {
        let _ = writer.write_record(row);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

impl Table {
    /// Cuts a text. Every row has as many cells as the header.
    pub fn cut(text: &str) -> Result<Self, TableError> {
        let mut rows = rows(text)?.into_iter();
        let Row { line, cells: names } = rows.next().ok_or(TableError::Empty("nothing"))?;
        if names.len() == 1 && names[0].contains([';', '\t']) {
            let problem = "separate the columns by commas, and write numbers with a point".into();
            return Err(TableError::Line { line, problem });
        }
        let twice = names.iter().enumerate().find(|(k, name)| names.iter().take(*k).any(|other| other == *name));
        if let Some((_, twice)) = twice {
            return Err(TableError::Line { line, problem: format!("there are two columns {}", quoted(twice)) });
        }
        let rows: Vec<Row> = rows.collect();
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
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Refuses columns that are neither known nor one of `others`.
    pub fn only<K>(&self, known: &[Known<K>], others: &[&str]) -> Result<(), TableError> {
        let expected = || known.iter().map(|column| column.name).chain(others.iter().copied());
        match self.names.iter().find(|name| !expected().any(|other| other == *name)) {
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
        self.names.iter().position(|other| other == name)
    }

    /// A complaint about the header.
    pub fn header_error(&self, problem: String) -> TableError {
        TableError::Line { line: self.line, problem }
    }
}

impl Row {
    /// Its cells.
    pub fn cells(&self) -> impl Iterator<Item = &str> {
        self.cells.iter()
    }

    /// A cell as it is written.
    pub fn text(&self, place: usize) -> &str {
        &self.cells[place]
    }

    /// A number in SI units; `None` for an empty cell.
    pub fn number<K>(&self, place: usize, column: &Known<K>) -> Result<Option<f64>, TableError> {
        let written = self.written(place, column.name, column.range)?;
        Ok(written.map(|value| value * column.factor + column.shift))
    }

    /// A number as it is written; `None` for an empty cell.
    pub fn written(&self, place: usize, column: &str, [low, high]: [f64; 2]) -> Result<Option<f64>, TableError> {
        let text = &self.cells[place];
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
        TableError::Cell { line: self.line, column, value: quoted(&self.cells[place]), allowed }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(text: &str) -> Vec<(usize, Vec<String>)> {
        rows(text).unwrap().iter().map(|row| (row.line, row.cells().map(str::to_owned).collect())).collect()
    }

    #[test]
    fn quotes_hold_commas_and_lines_are_those_of_the_text() {
        let text = "\u{feff}# by hand, \"today\n\n  a , \"b\", \"c\"\r\n\"1, 2\",\"say \"\"x\"\"!\",\n \t\n  # \"x\n\"3\n4\",5,6\n#\n7,8,9";
        let cell = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        let expected = [
            (3, cell(["a", "b", "c"])),
            (4, cell(["1, 2", "say \"x\"!", ""])),
            (7, cell(["3\n4", "5", "6"])),
            (10, cell(["7", "8", "9"])),
        ];
        assert_eq!(cut(text), expected);
    }

    #[test]
    fn open_quote_is_an_error_at_its_line() {
        let table = Table::cut("a,b\n1,2\n\n3,\"4\n5,6\n7,8\n").unwrap();
        let error = table.rows()[1].written(1, "b", [0.0, 9.0]).unwrap_err().to_string();
        assert_eq!(error, "line 4, column `b`: `4 5,6 7,8` is not allowed: a number from 0 to 9");
    }

    #[test]
    fn written_table_reads_back() {
        let text = written(&["phase", "x_m"], [["hold, then", "1"], ["say \"x\"", "2.5"]]);
        assert_eq!(text, "phase,x_m\n\"hold, then\",1\n\"say \"\"x\"\"\",2.5\n");
        assert_eq!(cut(&text)[1], (2, vec!["hold, then".to_owned(), "1".into()]));
    }
}
