//! Numbers over time in a CSV file that a scene names.

use std::path::Path;

use softlimb_files::table;

use crate::error::{Problem, quoted};
use crate::reader::Reader;
use crate::schema::Text;
use crate::source::{Located, read_text};

const ROWS_MAX: usize = 10_000;
/// Shortest time between two rows, s: knots are not closer.
const STEP_MIN_S: f64 = 1e-3;
/// Longest series, s.
const TIME_MAX_S: f64 = 3600.0;

/// The column of times, s.
pub(super) const TIME: &str = "time_s";

/// Columns of a file.
pub(super) struct Columns<'a> {
    /// Content of the file, in the plural.
    pub(super) what: &'a str,
    /// Leading columns: phase or time of a row.
    pub(super) lead: &'a [&'a str],
    pub(super) names: Vec<&'a str>,
    /// Optional columns, all or none, with the counts of `names`.
    pub(super) then: Vec<String>,
    /// Values of each name: those of a column with the name, or each in a column `name.1`, `name.2` and so on.
    pub(super) counts: Vec<usize>,
    /// Largest absolute value, and its unit with a space before it.
    pub(super) max: f64,
    pub(super) unit: &'a str,
}

impl Columns<'_> {
    /// The number of values of each column of a first row; the error is the row that it must be.
    fn widths(&self, header: &[&str]) -> Result<Vec<usize>, String> {
        let plain = || [self.lead, &self.names].concat().join(",");
        let parts = || match self.names.iter().zip(&self.counts).find(|(_, count)| **count > 1) {
            None => String::new(),
            Some((name, count)) => format!("; `{name}` may be parted into `{name}.1` to `{name}.{count}`"),
        };
        let then = || match self.then.join(",") {
            then if then.is_empty() => then,
            then => format!("; `{then}` may follow"),
        };
        let wrong = || format!(":1: the first row must be `{}`{}{}", plain(), parts(), then());
        let mut cells = header.strip_prefix(self.lead).ok_or_else(wrong)?.iter().copied().peekable();
        let mut widths = Vec::new();
        let names = self.names.iter().copied().chain(self.then.iter().map(String::as_str));
        for (index, (name, count)) in names.zip(self.counts.iter().cycle()).enumerate() {
            if index == self.names.len() && cells.peek().is_none() {
                break;
            }
            if cells.next_if(|cell| *cell == name).is_some() {
                widths.push(*count);
                continue;
            }
            for part in 1..=*count {
                let missing = || match part {
                    1 => wrong(),
                    _ => format!(
                        ":1: column `{name}.{part}` is missing: `{name}` is parted into `{name}.1` to `{name}.{count}`"
                    ),
                };
                cells.next_if(|cell| *cell == format!("{name}.{part}")).ok_or_else(missing)?;
                widths.push(1);
            }
        }
        if cells.next().is_some() { Err(wrong()) } else { Ok(widths) }
    }
}

/// A row of a file.
pub(super) struct Cells {
    /// Number of its line.
    pub(super) line: usize,
    /// Texts of the leading columns.
    pub(super) lead: Vec<String>,
    /// The values, one for each count.
    pub(super) values: Vec<f64>,
}

impl Cells {
    /// A number in one of the first columns, with the column's name and range.
    ///
    /// # Errors
    /// What is wrong, as it follows the file's name.
    pub(super) fn number(&self, index: usize, column: &str, [low, high]: [f64; 2]) -> Result<f64, String> {
        let why = match self.lead[index].parse::<f64>() {
            Ok(found) if (low..=high).contains(&found) => return Ok(found),
            Ok(found) if found.is_finite() => format!("{found} is not allowed: {low} to {high}"),
            _ => format!("{} is not a finite number", quoted(&self.lead[index])),
        };
        Err(format!(":{}: `{column}`: {why}", self.line))
    }
}

/// Time, s, and the values of a row.
pub(super) type Row = (f64, Vec<f64>);

/// The rows of the file that `key` names, at least two, with rising times; notes what is wrong.
///
/// `scene_name` is the scene's path, in whose folder the file is looked for.
pub(super) fn series(
    reader: &Reader<'_>,
    key: &'static Text,
    scene_name: &str,
    columns: &Columns<'_>,
) -> Option<Located<Vec<Row>>> {
    file(reader, key, scene_name, columns, timed)
}

/// Reads the file that `key` names and converts its rows by `read`; notes problems.
pub(super) fn file<T>(
    reader: &Reader<'_>,
    key: &'static Text,
    scene_name: &str,
    columns: &Columns<'_>,
    read: impl FnOnce(Vec<Cells>) -> Result<T, String>,
) -> Option<Located<T>> {
    let file = reader.text(key)?;
    let path = Path::new(scene_name).parent().unwrap_or(Path::new("")).join(file.value);
    let text = match read_text(&path) {
        Ok(text) => text,
        Err(reason) => {
            let title = format!("cannot read the {} {}", columns.what, path.display());
            return reader.log().note(Problem::at(file.span, title, reason.to_string()));
        }
    };
    match rows(&text, columns).and_then(read) {
        Ok(rows) => Some(file.map(|_| rows)),
        Err(why) => reader.log().note(Problem::at(file.span, format!("{}{why}", file.value), "in this file")),
    }
}

/// The rows of a file.
///
/// # Errors
/// What is wrong, as it follows the file's name: `:row: column: reason`.
fn rows(text: &str, columns: &Columns<'_>) -> Result<Vec<Cells>, String> {
    let mut lines = table::rows(text).map_err(|error| format!(": {error}"))?.into_iter();
    let header = lines.next();
    let header: Vec<&str> = header.iter().flat_map(table::Row::cells).collect();
    let widths = columns.widths(&header)?;
    let read = |cells: table::Row| {
        let line = cells.line;
        row(&cells, &header, &widths, columns).map_err(|why| format!(":{line}: {why}"))
    };
    let rows = lines.map(read).collect::<Result<Vec<_>, _>>()?;
    match rows.len() {
        0..=ROWS_MAX => Ok(rows),
        count => Err(format!(": there are {count} rows below the header; at most {ROWS_MAX} are read")),
    }
}

/// Rows as a series in time.
fn timed(rows: Vec<Cells>) -> Result<Vec<Row>, String> {
    let mut series: Vec<Row> = Vec::new();
    for cells in rows {
        let (line, time_s) = (cells.line, cells.number(0, TIME, [f64::MIN, f64::MAX])?);
        if series.last().is_some_and(|(last_s, _)| time_s < last_s + STEP_MIN_S) {
            return Err(format!(":{line}: `{TIME}`: {time_s} is not at least 1 ms after the row before"));
        }
        if series.first().is_some_and(|(first_s, _)| time_s - first_s > TIME_MAX_S) {
            return Err(format!(":{line}: `{TIME}`: the series is longer than {TIME_MAX_S} s"));
        }
        series.push((time_s, cells.values));
    }
    match series.len() {
        2.. => Ok(series),
        count => Err(format!(": there are {count} rows below the header; a series has 2 to {ROWS_MAX}")),
    }
}

fn row(row: &table::Row, header: &[&str], widths: &[usize], columns: &Columns<'_>) -> Result<Cells, String> {
    let cells: Vec<&str> = row.cells().collect();
    if cells.len() != header.len() {
        return Err(format!("{} values, not {}", cells.len(), header.len()));
    }
    let (lead, values) = cells.split_at(columns.lead.len());
    let number = |cell: &str, column: &str| match cell.parse::<f64>() {
        Ok(found) if found.abs() <= columns.max => Ok(found),
        Ok(found) if found.is_finite() => Err(format!("`{column}`: {found} is beyond {}{}", columns.max, columns.unit)),
        _ => Err(format!("`{column}`: {} is not a finite number", quoted(cell))),
    };
    let mut all = Vec::new();
    for ((cell, column), width) in values.iter().zip(&header[columns.lead.len()..]).zip(widths) {
        all.extend(std::iter::repeat_n(number(cell, column)?, *width));
    }
    Ok(Cells { line: row.line, lead: lead.iter().map(|cell| (*cell).to_owned()).collect(), values: all })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAD: [&str; 1] = [TIME];

    fn read(text: &str) -> Result<Vec<Row>, String> {
        let names = vec!["x_m", "y_m", "z_m"];
        let columns = Columns {
            what: "markers",
            lead: &LEAD,
            names,
            then: Vec::new(),
            counts: vec![1; 3],
            max: 100.0,
            unit: " m",
        };
        rows(text, &columns).and_then(timed)
    }

    #[test]
    fn columns_may_be_parted() {
        let columns = Columns {
            what: "corrections",
            lead: &LEAD,
            names: vec!["upper", "lower"],
            then: vec!["upper.planned".to_owned(), "lower.planned".to_owned()],
            counts: vec![3, 2],
            max: f64::MAX,
            unit: "",
        };
        let read = |text: &str| rows(text, &columns).and_then(timed);
        let one_each = read("time_s,upper,lower\n0,1,2\n1,3,4\n").unwrap();
        assert_eq!(one_each, [(0.0, vec![1.0, 1.0, 1.0, 2.0, 2.0]), (1.0, vec![3.0, 3.0, 3.0, 4.0, 4.0])]);
        let parted = read("time_s,upper.1,upper.2,upper.3,lower\n0,1,2,3,4\n1,5,6,7,8\n").unwrap();
        assert_eq!(parted, [(0.0, vec![1.0, 2.0, 3.0, 4.0, 4.0]), (1.0, vec![5.0, 6.0, 7.0, 8.0, 8.0])]);
        let more = read("time_s,upper,lower,upper.planned,lower.planned.1,lower.planned.2\n0,1,2,3,4,5\n1,0,0,0,0,0\n")
            .unwrap();
        assert_eq!(more[0].1, [1.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 4.0, 5.0]);
        let must = ":1: the first row must be `time_s,upper,lower`; `upper` may be parted into `upper.1` to `upper.3`; \
                    `upper.planned,lower.planned` may follow";
        for wrong in ["time_s,lower,upper", "time_s,upper,lower,lower", "time_s,upper"] {
            assert_eq!(read(&format!("{wrong}\n0,1,2\n")).unwrap_err(), must, "{wrong}");
        }
        for (wrong, column, parted) in [
            ("time_s,upper.1,upper.2,lower", "upper.3", "`upper` is parted into `upper.1` to `upper.3`"),
            ("time_s,upper,lower.1", "lower.2", "`lower` is parted into `lower.1` to `lower.2`"),
            (
                "time_s,upper,lower,upper.planned,lower.planned.1",
                "lower.planned.2",
                "`lower.planned` is parted into `lower.planned.1` to `lower.planned.2`",
            ),
        ] {
            let must = format!(":1: column `{column}` is missing: {parted}");
            assert_eq!(read(&format!("{wrong}\n0,1,2\n")).unwrap_err(), must, "{wrong}");
        }
        let wrong = read("time_s,upper,lower.1,lower.2\n0,1,2,x\n1,1,2,3\n").unwrap_err();
        assert_eq!(wrong, ":2: `lower.2`: `x` is not a finite number");
    }

    #[test]
    fn rows_are_read_and_wrong_ones_named() {
        let found = read("time_s, x_m, y_m, z_m\n\n2.0,0.1,0.2,0.3\n2.5,0,0,-1\n").unwrap();
        assert_eq!(found, [(2.0, vec![0.1, 0.2, 0.3]), (2.5, vec![0.0, 0.0, -1.0])]);
        let wrong = |body: &str| read(&format!("time_s,x_m,y_m,z_m\n{body}")).unwrap_err();
        assert_eq!(wrong("0,0,0,0\n1,0,abc,0\n"), ":3: `y_m`: `abc` is not a finite number");
        assert_eq!(wrong("0,0,0,0\n1,0,nan,0\n"), ":3: `y_m`: `nan` is not a finite number");
        assert_eq!(wrong("0,0,0,0\n1,0,0,500\n"), ":3: `z_m`: 500 is beyond 100 m");
        assert_eq!(wrong("0,0,0,0\ninf,0,0,0\n"), ":3: `time_s`: `inf` is not a finite number");
        assert_eq!(wrong("0,0,0\n"), ":2: 3 values, not 4");
        assert_eq!(wrong("1,0,0,0\n1,0,0,0\n"), ":3: `time_s`: 1 is not at least 1 ms after the row before");
        assert_eq!(wrong("0,0,0,0\n4000,0,0,0\n"), ":3: `time_s`: the series is longer than 3600 s");
        assert_eq!(wrong("1,0,0,0\n"), ": there are 1 rows below the header; a series has 2 to 10000");
        assert!(read("t,x,y,z\n").unwrap_err().starts_with(":1: the first row must be"));
    }
}
