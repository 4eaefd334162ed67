//! The table as a file of tab-separated values that a review can read, and back.

use std::fmt::Write;

use super::callgrind::Count;
use super::measure::Accuracy;
use super::reference::Doubt;
use super::report::{Cost, McuCost, Report, Row, figure, significant};

const HEADING: &str = "problem\tmethod\tmotion\tscalar\tasked\tfound\tmax error\tmedian error\tsteps\ttime\tinstructions\tflops\tmcu\tcycles";
const SET: [&str; 6] = ["seed", "actuators", "answered", "residual", "last step", "quadrature"];
/// Name of the line that holds the counts of the polynomial.
const POLYNOMIAL: &str = "polynomial of degree 8";

/// A line of a file that is no line of a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the table is not as the program writes it: {text}")]
pub struct TsvError {
    line: usize,
    text: String,
}

impl TsvError {
    /// The line of an index from zero.
    pub(super) fn new(index: usize, text: &str) -> Self {
        Self { line: index + 1, text: text.to_owned() }
    }
}

impl Report {
    /// The table as tab-separated values: lines of `# name<tab>value` about the set, the names of the columns, and the lines of the table.
    /// A dash is a figure that was not measured.
    pub fn tsv(&self) -> String {
        let Doubt { residual, step, quadrature } = self.doubt;
        let mut text = String::new();
        let whole = [self.seed, self.asked as u64, self.answered as u64].map(|value| value.to_string());
        let small = [residual, step, quadrature].map(|value| format!("{value:.1e}"));
        for (name, value) in SET.iter().zip(whole.iter().chain(&small)) {
            let _ = writeln!(text, "# {name}\t{value}");
        }
        if let Some(Count { instructions, flops }) = self.polynomial {
            let _ = writeln!(text, "# {POLYNOMIAL}\t{instructions:.1}\t{}", figure(flops, 1));
        }
        let _ = writeln!(text, "{HEADING}");
        for row in &self.rows {
            let Accuracy { asked, solved, max_error, median_error, steps } = row.accuracy;
            let (instructions, flops) = row.cost.counted();
            let (mcu, cycles) = row.cost.emulated();
            let _ = writeln!(
                text,
                "{}\t{asked}\t{solved}\t{max_error:.2e}\t{median_error:.2e}\t{steps:.2}\t{}\t{}\t{}\t{}\t{}",
                row.names.join("\t"),
                significant(row.cost.time),
                figure(instructions, 0),
                figure(flops, 0),
                figure(mcu, 0),
                figure(cycles, 0),
            );
        }
        text
    }

    /// Reads what [`tsv`](Self::tsv) wrote, to the digits it wrote.
    ///
    /// # Errors
    /// [`TsvError`] names the first line that is none of a table.
    pub fn from_tsv(text: &str) -> Result<Self, TsvError> {
        let mut report = Self::default();
        for (index, line) in text.lines().enumerate() {
            let entry = report.rows.len();
            let read = match line.strip_prefix("# ") {
                Some(about) => report.about(about),
                None if line == HEADING => Some(()),
                None => row(entry, line).map(|row| report.rows.push(row)),
            };
            read.ok_or_else(|| TsvError::new(index, line))?;
        }
        Ok(report)
    }

    fn about(&mut self, line: &str) -> Option<()> {
        let cells: Vec<_> = line.split('\t').collect();
        let [name, value, ref more @ ..] = cells[..] else { return None };
        let [seed, asked, answered, residual, step, quadrature] = SET;
        match name {
            POLYNOMIAL => {
                let flops = optional(more.first()?)?;
                self.polynomial = Some(Count { instructions: value.parse().ok()?, flops });
            }
            _ if name == seed => self.seed = value.parse().ok()?,
            _ if name == asked => self.asked = value.parse().ok()?,
            _ if name == answered => self.answered = value.parse().ok()?,
            _ if name == residual => self.doubt.residual = value.parse().ok()?,
            _ if name == step => self.doubt.step = value.parse().ok()?,
            _ if name == quadrature => self.doubt.quadrature = value.parse().ok()?,
            _ => return None,
        }
        Some(())
    }
}

fn row(entry: usize, line: &str) -> Option<Row> {
    let cells: Vec<_> = line.split('\t').collect();
    let [problem, method, motion, scalar, asked, solved, max, median, steps, time, instructions, flops, mcu, cycles] =
        cells[..]
    else {
        return None;
    };
    let accuracy = Accuracy {
        asked: asked.parse().ok()?,
        solved: solved.parse().ok()?,
        max_error: max.parse().ok()?,
        median_error: median.parse().ok()?,
        steps: steps.parse().ok()?,
    };
    let flops = optional(flops)?;
    let count = optional(instructions)?.map(|instructions| Count { instructions, flops });
    let mcu = match (optional(mcu)?, optional(cycles)?) {
        (Some(instructions), Some(cycles)) => Some(McuCost { instructions, cycles }),
        (None, None) => None,
        _ => return None,
    };
    let names = [problem, method, motion, scalar].map(str::to_owned);
    Some(Row { entry, names, accuracy, cost: Cost { time: optional(time)?, count, mcu } })
}

/// A figure or a dash.
fn optional(cell: &str) -> Option<Option<f64>> {
    if cell == "-" { Some(None) } else { cell.parse().ok().map(Some) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_is_read_as_it_was_written() {
        let text = "# seed\t3\n# actuators\t40\n# answered\t39\n# residual\t1.0e-28\n# last step\t2.0e-30\n# quadrature\t3.0e-29\n\
                    # polynomial of degree 8\t24.0\t16.0\n"
            .to_owned()
            + HEADING
            + "\nforward\tforward\textension\tf64\t10\t9\t1.20e-15\t1.00e-16\t5.25\t1.0\t4000\t900\t-\t-\n\
               inverse\tB0\tbending\tf32\t10\t10\t1.90e0\t4.00e-1\t0.00\t0.010\t-\t-\t1300\t2500\n";
        let report = Report::from_tsv(&text).expect("a table");
        assert_eq!((report.rows.len(), report.asked, report.rows[1].cost.count), (2, 40, None));
        assert_eq!(report.tsv(), text);
    }

    #[test]
    fn line_that_is_none_is_named() {
        let error = Report::from_tsv("# seed\t3\nforward\tforward\n").unwrap_err();
        assert!(error.to_string().starts_with("line 2 of the table"), "{error}");
        assert!(Report::from_tsv("# seed\tmany\n").is_err() && Report::from_tsv("# color\tred\n").is_err());
    }
}
