//! Instructions and cycles of a microcontroller, from the table that `cargo xtask model-image --record` writes.

use super::report::{McuCost, Report, Row};

/// The names of that table for ours.
const QUESTIONS: [(&str, &str); 5] = [
    ("forward, sheet", "forward, cold"),
    ("forward_from, sheet", "forward, warm"),
    ("inverse, sheet", "inverse, cold"),
    ("inverse_from, sheet", "inverse, warm"),
    ("inverse_near, sheet", "inverse, warm, within a budget"),
];
const HEADING: &str = "question\tactuator\tinstructions\tcycles\t";

/// A table that is not as the image's recorder writes it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum McuError {
    /// The names of its columns are missing.
    #[error("no line of columns that begins with `question`, `actuator`, `instructions`, `cycles`")]
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
    let mut counts: Vec<([&str; 2], McuCost)> = Vec::new();
    let mut begun = false;
    for (index, line) in table.lines().enumerate().filter(|(_, line)| !line.starts_with('#')) {
        if !begun {
            begun = line.starts_with(HEADING);
            continue;
        }
        counts.push(read(line).ok_or(McuError::Line { line: index + 1 })?);
    }
    if !begun {
        return Err(McuError::NoColumns);
    }
    for row in &mut report.rows {
        row.cost.mcu = find(&counts, row);
    }
    Ok(())
}

/// Question, actuator and cost of a line.
fn read(line: &str) -> Option<([&str; 2], McuCost)> {
    let mut cells = line.split('\t');
    let name = [cells.next()?, cells.next()?];
    let mut count = || cells.next()?.parse::<u32>().ok().map(f64::from);
    Some((name, McuCost { instructions: count()?, cycles: count()? }))
}

fn find(counts: &[([&str; 2], McuCost)], row: &Row) -> Option<McuCost> {
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
    counts.iter().find(|(name, _)| *name == [asked, of.as_str()]).map(|(_, cost)| *cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# Cortex-M4F\nquestion\tactuator\tinstructions\tcycles\titerations\tstatus\n\
                         forward, cold\textension, sheet\t1240\t2360\t2\tsolved\ninverse, warm\tbending\t15204\t37000\t1\tsolved\n\
                         inverse, table\tdegree 16\t146\t242\t0\t-\n";

    fn report() -> Report {
        let line = |names: &str| format!("{names}\t4\t4\t1.0e-7\t1.0e-8\t2.00\t1.0\t-\t-\t-\t-\n");
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
            report.rows.iter().map(|row| row.cost.emulated()).collect::<Vec<_>>(),
            [(Some(146.0), Some(242.0)), (Some(1240.0), Some(2360.0)), (None, None), (Some(15204.0), Some(37000.0))]
        );
    }

    #[test]
    fn table_that_is_none_is_refused() {
        assert_eq!(join(&mut report(), "region,instructions\n"), Err(McuError::NoColumns));
        let broken = TABLE.replace("15204", "many");
        assert_eq!(join(&mut report(), &broken), Err(McuError::Line { line: 4 }));
    }
}
