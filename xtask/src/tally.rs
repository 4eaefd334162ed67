//! The sum over all test programs and the names of what was skipped, read from what they print.

use std::fmt;

/// Tests that passed, failed and were skipped so far, and steps that failed.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    passed: u64,
    failed: u64,
    skipped: Vec<String>,
    failures: Vec<String>,
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

    /// Notes a step that failed, once.
    pub(crate) fn fail(&mut self, name: &str) {
        if !self.failures.iter().any(|known| known == name) {
            self.failures.push(name.to_owned());
        }
    }

    /// The exit code where a step failed.
    pub(crate) fn outcome(&self) -> Result<(), u8> {
        if self.failures.is_empty() { Ok(()) } else { Err(1) }
    }
}

/// Names of what was skipped and of steps that failed, each in a line, then the sum in one.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A test that skips itself is one that the test program counts as passed.
        for name in &self.skipped {
            writeln!(f, "skipped: {name}")?;
        }
        for name in &self.failures {
            writeln!(f, "failed: {name}")?;
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
    fn what_was_skipped_and_what_failed_is_named_once_and_last() {
        let mut tally = Tally::default();
        for line in [
            "   Compiling skipped: v0.1.0",
            "skipped: the_twin_is_alike; install it",
            "skipped: the_twin_is_alike; install it",
            "test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out",
        ] {
            tally.read(line);
        }
        tally.skip("model-image");
        assert_eq!(tally.outcome(), Ok(()), "what is skipped has not failed");
        tally.fail("host/tests/cli.rs");
        tally.fail("host/tests/cli.rs");
        let text = tally.to_string();
        let lines: Vec<_> = text.lines().collect();
        let [names @ .., sum] = &lines[..] else { panic!("no lines") };
        assert_eq!(names, ["skipped: the_twin_is_alike", "skipped: model-image", "failed: host/tests/cli.rs"]);
        assert!(sum.starts_with("2 passed, 0 failed, 2 of them"), "{text}");
        assert_eq!(tally.outcome(), Err(1));
    }
}
