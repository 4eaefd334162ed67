//! The table an image prints: one answer a line, fields separated by tabs.

/// One answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) question: String,
    pub(crate) actuator: String,
    /// Counts of the timer as printed, instructions once converted; none where nothing counts.
    pub(crate) cost: Option<i64>,
    /// Cycles of the processor, by an estimate; none where nothing was traced.
    pub(crate) cycles: Option<i64>,
    pub(crate) iterations: String,
    pub(crate) status: String,
    /// Bits of the answer and of its digest.
    pub(crate) bits: [String; 2],
}

impl Row {
    /// The question.
    pub(crate) fn name(&self) -> (&str, &str) {
        (&self.question, &self.actuator)
    }
}

/// Reads the lines of an image.
///
/// # Errors
/// The first line that is none of a table.
pub(crate) fn read(text: &str) -> Result<Vec<Row>, String> {
    text.lines().map(|line| row(line).ok_or_else(|| format!("not a line of the image's table: {line}"))).collect()
}

/// With rows of the same question, one after another, put together: the most that any has cost, and all of them by their mean.
pub(crate) fn worst(rows: Vec<Row>) -> Vec<Row> {
    let mut together = Vec::new();
    for group in rows.chunk_by(|one, other| one.name() == other.name()) {
        let [first, _, ..] = group else {
            together.extend(group.iter().cloned());
            continue;
        };
        let count = group.len();
        let costs: Vec<i64> = group.iter().filter_map(|row| row.cost).collect();
        let cycles: Vec<i64> = group.iter().filter_map(|row| row.cycles).collect();
        let named = |what: &str, cost, cycles| Row {
            question: format!("{}, {what} of {count}", first.question),
            cost,
            cycles,
            ..first.clone()
        };
        together.push(named("worst", costs.iter().copied().max(), cycles.iter().copied().max()));
        together.push(named("mean", mean(&costs), mean(&cycles)));
    }
    together
}

fn mean(costs: &[i64]) -> Option<i64> {
    costs.iter().sum::<i64>().checked_div(i64::try_from(costs.len()).ok()?)
}

fn row(line: &str) -> Option<Row> {
    let fields: Vec<&str> = line.split('\t').collect();
    let [question, actuator, cost, iterations, status, value, digest] = fields[..] else { return None };
    let cost = if cost == "-" { None } else { Some(cost.parse().ok()?) };
    let [question, actuator, iterations, status, value, digest] =
        [question, actuator, iterations, status, value, digest].map(str::to_owned);
    Some(Row { question, actuator, cost, cycles: None, iterations, status, bits: [value, digest] })
}

#[cfg(test)]
mod tests {
    use super::{read, worst};

    #[test]
    fn a_question_asked_again_is_one_line_with_its_worst_and_one_with_its_mean() {
        let mut rows =
            read("a\tx\t7\t0\t-\t1\t1\nb\tx\t3\t0\t-\t1\t1\nb\tx\t5\t0\t-\t2\t2\nb\ty\t9\t0\t-\t1\t1\n").unwrap();
        for (row, cycles) in rows.iter_mut().zip([8, 12, 6, 10]) {
            row.cycles = Some(cycles);
        }
        let rows = worst(rows);
        let told: Vec<_> = rows.iter().map(|row| (row.name(), row.cost, row.cycles)).collect();
        assert_eq!(
            told,
            [
                (("a", "x"), Some(7), Some(8)),
                (("b, worst of 2", "x"), Some(5), Some(12)),
                (("b, mean of 2", "x"), Some(4), Some(9)),
                (("b", "y"), Some(9), Some(10)),
            ]
        );
    }

    #[test]
    fn lines_are_read_and_others_refused() {
        let rows = read("held\tbending\t120\t3\tsolved\t3f80\t0a\nrest\tb\t-\t0\t-\t1\t2\n").unwrap();
        assert_eq!((rows[0].name(), rows[0].cost, rows[1].cost), (("held", "bending"), Some(120), None));
        assert_eq!(rows[0].bits, ["3f80", "0a"]);
        for poor in ["held\tbending\t120\t3\tsolved\t3f80\n", "panic in line 3\n", "a\tb\tmany\t0\t-\t1\t2\n"] {
            assert!(read(poor).is_err(), "{poor}");
        }
    }
}
