//! The sum over all test programs and the names of what was skipped, read from what they print.

use std::fmt;

/// Tests that passed, failed and were skipped so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    passed: u64,
    failed: u64,
    skipped: Vec<String>,
}

impl Tally {
    /// Adds a line such as `test result: ok. 12 passed; 0 failed; 0 ignored; ...` or `skipped: a_test; why`; other lines add nothing.
    pub(crate) fn read(&mut self, line: &str) {
        if let Some(skipped) = line.strip_prefix("skipped: ") {
            self.skip(skipped.split(';').next().unwrap_or(skipped));
        }
        let Some(result) = line.strip_prefix("test result: ") else { return };
        // "ok. 12 passed" or "FAILED. 3 passed", then "1 failed", each behind a semicolon.
        for part in result.split(['.', ';']) {
            match part.split_whitespace().collect::<Vec<_>>()[..] {
                [count, "passed"] => self.passed += count.parse::<u64>().unwrap_or(0),
                [count, "failed"] => self.failed += count.parse::<u64>().unwrap_or(0),
                _ => {}
            }
        }
    }

    /// Notes what was skipped, once.
    pub(crate) fn skip(&mut self, name: &str) {
        if !self.skipped.iter().any(|known| known == name) {
            self.skipped.push(name.to_owned());
        }
    }

    /// Adds what another has read.
    pub(crate) fn add(&mut self, other: &Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        other.skipped.iter().for_each(|name| self.skip(name));
    }
}

/// Names of what was skipped, each in a line, then the sum in one.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A test that skips itself is one that the test program counts as passed.
        for name in &self.skipped {
            writeln!(f, "skipped: {name}")?;
        }
        write!(f, "{} passed, {} failed", self.passed, self.failed)?;
        match self.skipped.len() {
            0 => Ok(()),
            count => write!(f, ", {count} of them or steps skipped: the names are above"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Tally;

    #[test]
    fn results_of_all_programs_add_up() {
        let mut tally = Tally::default();
        for line in [
            "running 3 tests",
            "test a_name_that_says_1_passed ... ok",
            "test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 4 filtered out; finished in 0.35s",
            "",
            "test result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s",
        ] {
            tally.read(line);
        }
        assert_eq!(tally.to_string(), "15 passed, 2 failed");
    }

    #[test]
    fn what_was_skipped_is_named_once_and_last() {
        let (mut tally, mut errors) = (Tally::default(), Tally::default());
        tally.read("test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out");
        errors.read("   Compiling skipped: v0.1.0");
        errors.read("skipped: the_twin_is_alike; install it");
        errors.read("skipped: the_twin_is_alike; install it");
        tally.add(&errors);
        tally.skip("model-image");
        let text = tally.to_string();
        assert_eq!(text.lines().collect::<Vec<_>>()[..2], ["skipped: the_twin_is_alike", "skipped: model-image"]);
        assert!(text.lines().last().unwrap().starts_with("2 passed, 0 failed, 2 of them"), "{text}");
        assert_eq!(text.lines().count(), 3);
    }
}
