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

/// The first column, s.
const TIME: &str = "time_s";

/// What a file has beside its times.
pub(super) struct Columns<'a> {
    /// What the file holds, in the plural.
    pub(super) what: &'a str,
    pub(super) names: Vec<&'a str>,
    /// Largest absolute value, and its unit with a space before it.
    pub(super) max: f64,
    pub(super) unit: &'a str,
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
    let file = reader.text(key)?;
    let path = Path::new(scene_name).parent().unwrap_or(Path::new("")).join(file.value);
    let text = match read_text(&path) {
        Ok(text) => text,
        Err(reason) => {
            let title = format!("cannot read the {} {}", columns.what, path.display());
            return reader.log().note(Problem::at(file.span, title, reason.to_string()));
        }
    };
    match rows(&text, columns) {
        Ok(rows) => Some(file.map(|_| rows)),
        Err(why) => reader.log().note(Problem::at(file.span, format!("{}{why}", file.value), "in this file")),
    }
}

/// The rows of a file.
///
/// # Errors
/// What is wrong, as it follows the file's name: `:row: column: reason`.
fn rows(text: &str, columns: &Columns<'_>) -> Result<Vec<Row>, String> {
    let mut lines = table::rows(text).map_err(|error| format!(": {error}"))?.into_iter();
    let wanted: Vec<&str> = std::iter::once(TIME).chain(columns.names.iter().copied()).collect();
    if !lines.next().is_some_and(|header| header.cells().eq(wanted.iter().copied())) {
        return Err(format!(":1: the first row must be `{}`", wanted.join(",")));
    }
    let mut rows: Vec<Row> = Vec::new();
    for cells in lines {
        let number = cells.line;
        let (time_s, values) = row(&cells, columns).map_err(|why| format!(":{number}: {why}"))?;
        if rows.last().is_some_and(|(last_s, _)| time_s < last_s + STEP_MIN_S) {
            return Err(format!(":{number}: `{TIME}`: {time_s} is not at least 1 ms after the row before"));
        }
        if rows.first().is_some_and(|(first_s, _)| time_s - first_s > TIME_MAX_S) {
            return Err(format!(":{number}: `{TIME}`: the series is longer than {TIME_MAX_S} s"));
        }
        rows.push((time_s, values));
    }
    match rows.len() {
        2..=ROWS_MAX => Ok(rows),
        count => Err(format!(": there are {count} rows below the header; a series has 2 to {ROWS_MAX}")),
    }
}

fn row(row: &table::Row, columns: &Columns<'_>) -> Result<Row, String> {
    let cells: Vec<&str> = row.cells().collect();
    let count = columns.names.len() + 1;
    let [time_s, values @ ..] = &cells[..] else { return Err(format!("0 values, not {count}")) };
    if cells.len() != count {
        return Err(format!("{} values, not {count}", cells.len()));
    }
    let number = |cell: &str, column: &str, max: f64| match cell.parse::<f64>() {
        Ok(found) if found.abs() <= max => Ok(found),
        Ok(found) if found.is_finite() => Err(format!("`{column}`: {found} is beyond {max}{}", columns.unit)),
        _ => Err(format!("`{column}`: {} is not a finite number", quoted(cell))),
    };
    let time_s = number(time_s, TIME, f64::MAX)?;
    let cells = values.iter().zip(&columns.names);
    Ok((time_s, cells.map(|(cell, column)| number(cell, column, columns.max)).collect::<Result<_, _>>()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Row>, String> {
        rows(text, &Columns { what: "markers", names: vec!["x_m", "y_m", "z_m"], max: 100.0, unit: " m" })
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
