//! The table an image prints: one answer a line, fields separated by tabs.

/// One answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) question: String,
    pub(crate) actuator: String,
    /// Counts of the timer as printed, instructions once converted; none where nothing counts.
    pub(crate) cost: Option<i64>,
    pub(crate) iterations: String,
    pub(crate) status: String,
    /// Bits of the answer and of its digest.
    pub(crate) bits: [String; 2],
}

impl Row {
    /// What was asked.
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

fn row(line: &str) -> Option<Row> {
    let fields: Vec<&str> = line.split('\t').collect();
    let [question, actuator, cost, iterations, status, value, digest] = fields[..] else { return None };
    let cost = if cost == "-" { None } else { Some(cost.parse().ok()?) };
    let [question, actuator, iterations, status, value, digest] =
        [question, actuator, iterations, status, value, digest].map(str::to_owned);
    Some(Row { question, actuator, cost, iterations, status, bits: [value, digest] })
}

#[cfg(test)]
mod tests {
    use super::read;

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
