//! A motion as a series of tip positions in a CSV file.

use std::path::Path;

use crate::scene::data::Marker;
use crate::scene::error::{Problem, quoted};
use crate::scene::reader::Reader;
use crate::scene::schema::{self, markers as keys};
use crate::scene::source::{Located, read_text};

const HEADER: [&str; 4] = ["time_s", "x_m", "y_m", "z_m"];
const ROWS_MAX: usize = 10_000;
/// Shortest time between two rows, s: knots are not closer.
const STEP_MIN_S: f64 = 1e-3;
/// Longest series, s.
const TIME_MAX_S: f64 = 3600.0;
/// Farthest position, m, as in a scene.
const FAR_M: f64 = 100.0;

/// The series of a scene that has `[markers]`, located at the name of its file; the inner `None` where it has none.
///
/// `scene_name` is the scene's path, in whose folder the file is looked for.
pub(super) fn markers(root: &Reader<'_>, scene_name: &str) -> Option<Option<Located<Vec<Marker>>>> {
    let Some(value) = root.value(schema::scene::MARKERS.name) else { return Some(None) };
    let reader = Reader::open(root.log(), value, &keys::SECTION, &quoted(schema::scene::MARKERS.name))?;
    let file = reader.text(&keys::FILE)?;
    let path = Path::new(scene_name).parent().unwrap_or(Path::new("")).join(file.value);
    let text = match read_text(&path) {
        Ok(text) => text,
        Err(reason) => {
            let title = format!("cannot read the markers {}", path.display());
            return reader.log().note(Problem::at(file.span, title, reason.to_string()));
        }
    };
    match rows(&text) {
        Ok(rows) => Some(Some(file.map(|_| rows))),
        Err(why) => reader.log().note(Problem::at(file.span, format!("{}{why}", file.value), "in this file")),
    }
}

/// The rows of a file, with times from the first one on.
///
/// # Errors
/// What is wrong, as it follows the file's name: `:row: column: reason`.
fn rows(text: &str) -> Result<Vec<Marker>, String> {
    let mut lines = text.lines().zip(1_usize..).filter(|(line, _)| !line.trim().is_empty());
    let header = lines.next().map(|(line, _)| line.split(',').map(str::trim).collect::<Vec<_>>());
    if header.as_deref() != Some(&HEADER[..]) {
        return Err(format!(":1: the first row must be `{}`", HEADER.join(",")));
    }
    let mut rows: Vec<Marker> = Vec::new();
    let mut first_s = None;
    for (line, number) in lines {
        let [time_s, x, y, z] = row(line).map_err(|why| format!(":{number}: {why}"))?;
        let first = *first_s.get_or_insert(time_s);
        let marker = Marker { time_s: time_s - first, tip_m: [x, y, z] };
        if rows.last().is_some_and(|last| marker.time_s < last.time_s + STEP_MIN_S) {
            return Err(format!(":{number}: `time_s`: {time_s} is not at least 1 ms after the row before"));
        }
        if marker.time_s > TIME_MAX_S {
            return Err(format!(":{number}: `time_s`: the series is longer than {TIME_MAX_S} s"));
        }
        rows.push(marker);
    }
    match rows.len() {
        2..=ROWS_MAX => Ok(rows),
        count => Err(format!(": there are {count} rows below the header; a series has 2 to {ROWS_MAX}")),
    }
}

fn row(line: &str) -> Result<[f64; 4], String> {
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    if cells.len() != HEADER.len() {
        return Err(format!("{} values, not {}", cells.len(), HEADER.len()));
    }
    let mut values = [0.0; 4];
    for ((value, cell), column) in values.iter_mut().zip(&cells).zip(HEADER) {
        let most = if column == HEADER[0] { f64::MAX } else { FAR_M };
        *value = match cell.parse::<f64>() {
            Ok(found) if found.abs() <= most => found,
            Ok(found) if found.is_finite() => return Err(format!("`{column}`: {found} is beyond {FAR_M} m")),
            _ => return Err(format!("`{column}`: {} is not a finite number", quoted(cell))),
        };
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_and_wrong_ones_named() {
        let read = rows("time_s, x_m, y_m, z_m\n\n2.0,0.1,0.2,0.3\n2.5,0,0,-1\n").unwrap();
        assert_eq!(
            read,
            [Marker { time_s: 0.0, tip_m: [0.1, 0.2, 0.3] }, Marker { time_s: 0.5, tip_m: [0.0, 0.0, -1.0] }]
        );
        let wrong = |body: &str| rows(&format!("time_s,x_m,y_m,z_m\n{body}")).unwrap_err();
        assert_eq!(wrong("0,0,0,0\n1,0,abc,0\n"), ":3: `y_m`: `abc` is not a finite number");
        assert_eq!(wrong("0,0,0,0\n1,0,nan,0\n"), ":3: `y_m`: `nan` is not a finite number");
        assert_eq!(wrong("0,0,0,0\n1,0,0,500\n"), ":3: `z_m`: 500 is beyond 100 m");
        assert_eq!(wrong("0,0,0\n"), ":2: 3 values, not 4");
        assert_eq!(wrong("1,0,0,0\n1,0,0,0\n"), ":3: `time_s`: 1 is not at least 1 ms after the row before");
        assert_eq!(wrong("1,0,0,0\n"), ": there are 1 rows below the header; a series has 2 to 10000");
        assert!(rows("t,x,y,z\n").unwrap_err().starts_with(":1: the first row must be"));
    }
}
