//! The comparison as a file of tab-separated values, and back.

use std::fmt::Write;

use fra_model::Motion;

use super::case::label;
use super::compare::{Comparison, Row};

const HEADING: &str = "case\tquantity\trest\tpressure, kPa\tanalytic\tcalibrated\tsection\tits error\tCalculiX";

/// A line of a file that is no line of a comparison.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the comparison is not as the program writes it: {text}")]
pub struct TsvError {
    line: usize,
    text: String,
}

impl Comparison {
    /// The rows as tab-separated values below the names of their columns. A dash is a figure that is not there.
    pub fn tsv(&self) -> String {
        let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.7}"));
        let mut text = format!("{HEADING}\n");
        for row in &self.rows {
            let error = row.section_error.map_or_else(|| "-".to_owned(), |error| format!("{error:.1e}"));
            let _ = writeln!(
                text,
                "{}\t{}\t{}\t{}\t{}\t{}\t{}\t{error}\t{}",
                row.case,
                label(row.motion),
                row.rest,
                row.pressure_kpa,
                figure(row.analytic),
                figure(row.calibrated),
                figure(row.section),
                figure(row.solid),
            );
        }
        text
    }

    /// Reads what [`tsv`](Self::tsv) wrote, to the digits it wrote.
    ///
    /// # Errors
    /// [`TsvError`] names the first line that is none of a comparison.
    pub fn from_tsv(text: &str) -> Result<Self, TsvError> {
        let mut rows = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let read = if index == 0 { (line == HEADING).then_some(None) } else { row(line).map(Some) };
            let read = read.ok_or_else(|| TsvError { line: index + 1, text: line.to_owned() })?;
            rows.extend(read);
        }
        Ok(Self { rows })
    }
}

fn row(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.split('\t').collect();
    let [case, quantity, rest, pressure, analytic, calibrated, section, error, solid] = cells[..] else { return None };
    let finite = |cell: &str| cell.parse::<f64>().ok().filter(|value| value.is_finite());
    let number = |cell: &str| if cell == "-" { Some(None) } else { finite(cell).map(Some) };
    Some(Row {
        case: case.to_owned(),
        motion: Motion::ALL.into_iter().find(|motion| label(*motion) == quantity)?,
        rest: number(rest)??,
        pressure_kpa: number(pressure)??,
        analytic: number(analytic)?,
        calibrated: number(calibrated)?,
        section: number(section)?,
        section_error: number(error)?,
        solid: number(solid)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Comparison {
        let row = Row {
            case: "bending, 6/8 mm, Yeoh".into(),
            motion: Motion::Bending,
            rest: 0.0,
            pressure_kpa: 10.0,
            analytic: Some(12.9),
            calibrated: Some(12.84),
            section: Some(12.85),
            section_error: Some(1e-3),
            solid: None,
        };
        let beyond = Row {
            pressure_kpa: 20.0,
            analytic: None,
            calibrated: None,
            section: None,
            section_error: None,
            ..row.clone()
        };
        Comparison { rows: vec![row, beyond] }
    }

    #[test]
    fn written_scenes_are_read() {
        assert_eq!(Comparison::from_tsv(&sample().tsv()), Ok(sample()));
    }

    #[test]
    fn recorded_values_stay_without_new_ones() {
        let mut recorded = sample();
        recorded.rows[0].solid = Some(12.8);
        recorded.rows.push(Row { case: "twisting".into(), ..recorded.rows[0].clone() });
        let mut new = sample();
        new.rows[0].analytic = Some(12.91);
        new.rows.push(Row { case: "extension".into(), ..new.rows[0].clone() });
        let joined = new.onto(&recorded);
        let cases: Vec<_> = joined.rows.iter().map(|row| (row.case.as_str(), row.analytic, row.solid)).collect();
        let bending = "bending, 6/8 mm, Yeoh";
        assert_eq!(cases[..2], [(bending, Some(12.91), Some(12.8)), (bending, None, None)]);
        assert_eq!(cases[2..], [("twisting", Some(12.9), Some(12.8)), ("extension", Some(12.91), None)]);
    }

    #[test]
    fn first_wrong_line_is_named() {
        let text = sample().tsv().replace("20\t-", "twenty\t-");
        let error = Comparison::from_tsv(&text).expect_err("no number");
        assert!(error.to_string().starts_with("line 3 of the comparison"), "{error}");
        assert!(Comparison::from_tsv("case\n").is_err());
        assert!(Comparison::from_tsv(&sample().tsv().replace("12.8400000", "NaN")).is_err());
    }
}
