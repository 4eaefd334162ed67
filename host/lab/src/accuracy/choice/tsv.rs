//! The record as tab-separated values, and back.

use std::fmt::Write;

use super::{Choice, Model, Row, Seconds};
use crate::accuracy::TsvError;

const HEADING: &str = "bender\tanalytic\tcubic\ttable\tsection FE\treference";
const SEED: &str = "seed";

impl Choice {
    /// The record: `# name<tab>value` for the seed and `# name<tab>preparation<tab>answer`, s, for the models; then errors, a line a bender. A
    /// dash is a figure that is missing.
    pub fn tsv(&self) -> String {
        let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2e}"));
        let mut text = format!("# {SEED}\t{}\n", self.seed);
        // Writing to a string cannot fail.
        for (model, Seconds { preparation, answer }) in Model::ALL.iter().zip(self.seconds) {
            let _ = writeln!(text, "# {}\t{}\t{}", model.name(), figure(preparation), figure(answer));
        }
        let _ = writeln!(text, "{HEADING}");
        for Row { bender, errors, reference } in &self.rows {
            let _ = writeln!(text, "{bender}\t{}\t{reference:.2e}", errors.map(figure).join("\t"));
        }
        text
    }

    /// Reads the text of [`tsv`](Self::tsv), to its digits.
    ///
    /// # Errors
    /// [`TsvError`] names the first line that does not belong to a record.
    pub fn from_tsv(text: &str) -> Result<Self, TsvError> {
        let mut choice = Self::default();
        for (index, line) in text.lines().enumerate() {
            let read = match line.strip_prefix("# ") {
                Some(about) => choice.about(about),
                None if line == HEADING => Some(()),
                None => row(line).map(|row| choice.rows.push(row)),
            };
            read.ok_or_else(|| TsvError::new(index, line))?;
        }
        Ok(choice)
    }

    fn about(&mut self, line: &str) -> Option<()> {
        match line.split('\t').collect::<Vec<_>>()[..] {
            [SEED, seed] => self.seed = seed.parse().ok()?,
            [name, preparation, answer] => {
                let model = Model::ALL.into_iter().find(|model| model.name() == name)?;
                self.seconds[model as usize] =
                    Seconds { preparation: optional(preparation)?, answer: optional(answer)? };
            }
            _ => return None,
        }
        Some(())
    }
}

fn row(line: &str) -> Option<Row> {
    let [bender, analytic, cubic, table, section, reference] = line.split('\t').collect::<Vec<_>>()[..] else {
        return None;
    };
    let errors = [optional(analytic)?, optional(cubic)?, optional(table)?, optional(section)?];
    Some(Row { bender: bender.to_owned(), errors, reference: reference.parse().ok()? })
}

/// A figure or a dash.
fn optional(cell: &str) -> Option<Option<f64>> {
    if cell == "-" { Some(None) } else { cell.parse().ok().map(Some) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn record_is_read_as_it_was_written() {
        let row = Row { bender: "a".into(), errors: [Some(0.0125), None, Some(1e-4), Some(3e-5)], reference: 2e-6 };
        let mut choice = Choice { seed: 3, rows: vec![row], ..Choice::default() };
        choice.seconds[4] = Seconds { preparation: None, answer: Some(150.0) };
        assert_eq!(Choice::from_tsv(&choice.tsv()).unwrap(), choice);
        for wrong in ["# seed\tmany\n", "# color\t1\t2\n", "# seed\t1\nbender\t1\n"] {
            let error = Choice::from_tsv(wrong).unwrap_err();
            assert!(error.to_string().contains("of the table is not as the program writes it"), "{error}");
        }
    }
}
