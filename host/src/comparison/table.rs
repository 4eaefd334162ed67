//! The comparison as tables.

use super::compare::{Comparison, Row};

/// One line for each case: the largest differences from the section over its pressures.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Name of the case.
    pub case: String,
    /// Least and highest gauge pressure, kPa.
    pub pressures_kpa: [f64; 2],
    /// As shares of the motion: analytic, calibrated, CalculiX; then the section's own error.
    pub worst: [Option<f64>; 4],
}

impl Comparison {
    /// The rows of each case.
    pub(super) fn by_case(&self) -> Vec<&[Row]> {
        self.rows.chunk_by(|a, b| a.case == b.case).collect()
    }

    /// The largest differences of each case.
    pub fn lines(&self) -> Vec<Line> {
        self.by_case().into_iter().map(line).collect()
    }

    /// Table for a terminal: every row, then the largest difference of each case.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for (rows, line) in self.by_case().into_iter().zip(self.lines()) {
            let label = rows.first().map_or_else(String::new, |row| super::case::label(row.motion));
            text += &format!("{}: {label}\n", line.case);
            text += "      kPa    analytic  calibrated     section      +-    CalculiX   analytic  CalculiX\n";
            for row in rows {
                text += &format!(
                    "{:>9.1} {:>11} {:>11} {:>11} {:>7} {:>11} {:>10} {:>9}\n",
                    row.pressure_kpa,
                    figure(row.analytic),
                    figure(row.calibrated),
                    figure(row.section),
                    row.section_error.map_or_else(|| "-".into(), |error| format!("{error:.0e}")),
                    figure(row.solid),
                    percent(row.difference(row.analytic)),
                    percent(row.difference(row.solid)),
                );
            }
            text.push('\n');
        }
        text
    }
}

fn line(rows: &[Row]) -> Line {
    let largest =
        |value: &dyn Fn(&Row) -> Option<f64>| rows.iter().filter_map(value).max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let pressures = rows.iter().map(|row| row.pressure_kpa);
    let (low, high) = pressures.fold((f64::INFINITY, 0.0), |(low, high), p| (f64::min(low, p), f64::max(high, p)));
    Line {
        case: rows.first().map_or_else(String::new, |row| row.case.clone()),
        pressures_kpa: [low, high],
        worst: [
            largest(&|row| row.difference(row.analytic)),
            largest(&|row| row.difference(row.calibrated)),
            largest(&|row| row.difference(row.solid)),
            largest(&|row| row.difference(Some(row.section? + row.section_error?)).map(f64::abs)),
        ],
    }
}

fn figure(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5}"))
}

/// A share in percent, with two digits that count.
pub fn percent(share: Option<f64>) -> String {
    let Some(share) = share.map(|share| 100.0 * share) else { return "-".to_owned() };
    match share.abs() {
        size if size < 1e-4 => "< 0.0001 %".to_owned(),
        size if size < 0.01 => format!("{share:.4} %"),
        _ => format!("{share:.2} %"),
    }
}
