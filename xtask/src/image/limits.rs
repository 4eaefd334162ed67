//! The most cycles that an answer may take.

use crate::table::Row;

/// By its question, however often that is asked, and the actuator where not every one is meant. A tick has 168 000. What solves the model
/// is held to it by the iteration, and a device takes two from a warm start; a bend it looks up.
const LIMITS: [(&str, &str, Per, i64); 8] = [
    ("turn, worst", "", Per::Answer, 50_000),
    ("turn, garbage on the link, worst", "", Per::Answer, 50_000),
    ("turn, configuration, worst", "", Per::Answer, 168_000),
    ("inverse, table", "", Per::Answer, 2_500),
    ("inverse, warm, as flashed", "", Per::Answer, 5_000),
    ("inverse, warm", "extension, sheet", Per::Iteration, 2_500),
    ("inverse, warm", "expansion, sheet", Per::Iteration, 2_500),
    ("inverse, warm", "twisting, sheet", Per::Iteration, 2_500),
];

/// What a limit is for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Per {
    Answer,
    Iteration,
}

/// Holds every answer to its limit.
///
/// # Errors
/// The answers that take more cycles; a limit that is for none.
pub(super) fn check(rows: &[Row]) -> Result<(), String> {
    let mut beyond = Vec::new();
    for (question, actuator, per, most) in LIMITS {
        let meant = |row: &&Row| is_meant(&row.question, question) && (actuator.is_empty() || row.actuator == actuator);
        let cycles = |row: &Row| row.cycles.map_or(i64::MAX, |cycles| cycles / parts(row, per));
        let Some(worst) = rows.iter().filter(meant).max_by_key(|row| cycles(row)) else {
            return Err(format!("nothing is asked that begins with `{question}`"));
        };
        let unit = if per == Per::Iteration { " an iteration" } else { "" };
        let told = format!("{}, {}: {} cycles{unit}, at most {most}", worst.question, worst.actuator, cycles(worst));
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

fn parts(row: &Row, per: Per) -> i64 {
    if per == Per::Iteration { row.iterations.parse().unwrap_or(1).max(1) } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::{LIMITS, check};
    use crate::table::{Row, read};

    fn row(question: &str, actuator: &str, cycles: i64, iterations: &str) -> Row {
        let mut row = read(&format!("{question}\t{actuator}\t1\t{iterations}\t-\t0\t0\n")).unwrap().remove(0);
        row.cycles = Some(cycles);
        row
    }

    fn at_the_limits() -> Vec<Row> {
        LIMITS.iter().map(|(question, actuator, _, most)| row(question, actuator, *most, "1")).collect()
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
    fn solvers_are_held_to_it_by_the_iteration() {
        let mut rows = at_the_limits();
        rows.push(row("inverse, warm", "twisting, sheet", 5_000, "2"));
        assert_eq!(check(&rows), Ok(()));
        rows.push(row("turn, worst of 7", "any", 50_001, "0"));
        assert!(check(&rows).is_err());
    }
}
