//! The most cycles that an answer may take.

use crate::table::Row;

/// By its question, however often that is asked, and the beginning of the actuator where not every one is meant. A tick has 168 000. A
/// bend is looked up.
const LIMITS: [(&str, &str, i64); 7] = [
    ("turn, worst", "", 50_000),
    ("turn, garbage on the link, worst", "", 50_000),
    ("turn, configuration, worst", "", 50_000),
    ("inverse, table", "", 2_500),
    ("inverse, warm, as flashed", "extension", 2_500),
    ("inverse, warm, as flashed", "expansion", 2_500),
    ("inverse, warm, as flashed", "twisting", 2_500),
];

/// Holds every answer to its limit.
///
/// # Errors
/// The answers that take more cycles; a limit that is for none.
pub(super) fn check(rows: &[Row]) -> Result<(), String> {
    let mut beyond = Vec::new();
    for (question, actuator, most) in LIMITS {
        let meant = |row: &&Row| is_meant(&row.question, question) && row.actuator.starts_with(actuator);
        let cycles = |row: &Row| row.cycles.unwrap_or(i64::MAX);
        let Some(worst) = rows.iter().filter(meant).max_by_key(|row| cycles(row)) else {
            return Err(format!("nothing is asked that begins with `{question}`"));
        };
        let told = format!("{}, {}: {} cycles, at most {most}", worst.question, worst.actuator, cycles(worst));
        println!("xtask: {told}");
        if cycles(worst) > most {
            beyond.push(told);
        }
    }
    if beyond.is_empty() {
        return Ok(());
    }
    Err(format!("more cycles than a device has for it:\n  {}", beyond.join("\n  ")))
}

/// Whether a question is the one of a limit, or that one asked many times.
fn is_meant(question: &str, of: &str) -> bool {
    question.strip_prefix(of).is_some_and(|rest| rest.is_empty() || rest.starts_with(" of "))
}

#[cfg(test)]
mod tests {
    use super::{LIMITS, check};
    use crate::table::{Row, read};

    fn row(question: &str, actuator: &str, cycles: i64) -> Row {
        let mut row = read(&format!("{question}\t{actuator}\t1\t1\t-\t0\t0\n")).unwrap().remove(0);
        row.cycles = Some(cycles);
        row
    }

    fn at_the_limits() -> Vec<Row> {
        LIMITS.iter().map(|(question, actuator, most)| row(question, actuator, *most)).collect()
    }

    #[test]
    fn an_answer_beyond_its_limit_is_refused() {
        assert_eq!(check(&at_the_limits()), Ok(()));
        for index in 0..LIMITS.len() {
            let mut rows = at_the_limits();
            rows[index].cycles = rows[index].cycles.map(|cycles| cycles + 1);
            assert!(check(&rows).is_err_and(|text| text.contains(LIMITS[index].0)));
            rows.remove(index);
            assert!(check(&rows).is_err(), "a limit for nothing");
        }
    }

    #[test]
    fn a_question_that_is_asked_often_is_held_to_its_limit() {
        let mut rows = at_the_limits();
        rows.push(row("inverse, warm", "twisting, sheet", 5_000));
        assert_eq!(check(&rows), Ok(()));
        rows.push(row("turn, worst of 7", "any", 50_001));
        assert!(check(&rows).is_err());
    }
}
