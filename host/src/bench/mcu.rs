//! Instruction counts of a microcontroller, from the table that `cargo xtask model-image --record` writes.

use super::report::{Report, Row};

/// The names of that table for ours.
const QUESTIONS: [(&str, &str); 5] = [
    ("forward, sheet", "forward, cold"),
    ("forward_from, sheet", "forward, warm"),
    ("inverse, sheet", "inverse, cold"),
    ("inverse_from, sheet", "inverse, warm"),
    ("inverse_near, sheet", "inverse, warm, within a budget"),
];
const HEADING: &str = "question\tactuator\tinstructions\t";

/// A table that is not as the image's recorder writes it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum McuError {
    /// The names of its columns are missing.
    #[error("no line of columns that begins with `question`, `actuator`, `instructions`")]
    NoColumns,
    /// A line that is none of the table.
    #[error("line {line} is not as `cargo xtask model-image --record` writes it")]
    Line {
        /// Its number, from 1.
        line: usize,
    },
}

/// Adds the counts of a table to the lines in single precision they belong to: those of an actuator of the line's motion with a
/// neo-Hookean wall, wound with a sheet, and those of looking up a table, which are the same for all.
///
/// # Errors
/// [`McuError`] where the table is none; the report is then unchanged.
pub fn join(report: &mut Report, table: &str) -> Result<(), McuError> {
    let mut counts: Vec<[&str; 3]> = Vec::new();
    let mut begun = false;
    for (index, line) in table.lines().enumerate().filter(|(_, line)| !line.starts_with('#')) {
        if !begun {
            begun = line.starts_with(HEADING);
            continue;
        }
        let mut cells = line.split('\t');
        let count = (cells.next(), cells.next(), cells.next());
        let (Some(question), Some(actuator), Some(count)) = count else {
            return Err(McuError::Line { line: index + 1 });
        };
        count.parse::<u64>().map_err(|_| McuError::Line { line: index + 1 })?;
        counts.push([question, actuator, count]);
    }
    if !begun {
        return Err(McuError::NoColumns);
    }
    for row in &mut report.rows {
        row.cost.mcu = find(&counts, row);
    }
    Ok(())
}

fn find(counts: &[[&str; 3]], row: &Row) -> Option<f64> {
    let [_, method, motion, scalar] = &row.names;
    if scalar != "f32" {
        return None;
    }
    let (asked, of) = match method.strip_prefix("table, ") {
        Some(degree) => ("inverse, table", degree.to_owned()),
        None => {
            let (_, asked) = QUESTIONS.iter().find(|(name, _)| name == method)?;
            (*asked, if motion == "bending" { motion.clone() } else { format!("{motion}, sheet") })
        }
    };
    let [.., count] = counts.iter().find(|[question, actuator, _]| *question == asked && *actuator == of)?;
    count.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# Cortex-M4F\nquestion\tactuator\tinstructions\titerations\tstatus\n\
                         forward, cold\textension, sheet\t1240\t2\tsolved\ninverse, warm\tbending\t15204\t1\tsolved\n\
                         inverse, table\tdegree 16\t146\t0\t-\n";

    fn report() -> Report {
        let line = |names: &str| format!("{names}\t4\t4\t1.0e-7\t1.0e-8\t2.00\t1.0\t-\t-\t-\n");
        let names = [
            "inverse\ttable, degree 16\ttwisting\tf32",
            "forward\tforward, sheet\textension\tf32",
            "forward\tforward, sheet\textension\tf64",
            "inverse\tinverse_from, sheet\tbending\tf32",
        ];
        Report::from_tsv(&names.map(line).concat()).expect("lines of a table")
    }

    #[test]
    fn counts_find_their_lines() {
        let mut report = report();
        join(&mut report, TABLE).unwrap();
        assert_eq!(
            report.rows.iter().map(|row| row.cost.mcu).collect::<Vec<_>>(),
            [Some(146.0), Some(1240.0), None, Some(15204.0)]
        );
    }

    #[test]
    fn a_table_that_is_none_is_refused() {
        assert_eq!(join(&mut report(), "region,instructions\n"), Err(McuError::NoColumns));
        let broken = TABLE.replace("15204", "many");
        assert_eq!(join(&mut report(), &broken), Err(McuError::Line { line: 4 }));
    }
}
