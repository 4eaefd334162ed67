//! Numbers of the command line that have a range.

use std::ops::RangeInclusive;

/// Reads a number of a range, both ends included.
pub(super) fn within(text: &str, range: RangeInclusive<f64>) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    let [low, high] = [range.start(), range.end()];
    if range.contains(&number) { Ok(number) } else { Err(format!("{number} is not in {low} to {high}")) }
}

/// Reads the seconds after which CalculiX is ended.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    within(text, 0.1..=1e6)
}

/// Reads a number above zero and up to `most`.
pub(super) fn positive(text: &str, most: f64) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    let fits = number > 0.0 && number <= most;
    if fits { Ok(number) } else { Err(format!("{number} is not above 0 and at most {most}")) }
}

/// Reads an even number of a range, both ends included.
pub(super) fn even(text: &str, range: RangeInclusive<u32>) -> Result<u32, String> {
    let number = text.parse::<u32>().map_err(|error| error.to_string())?;
    let fits = range.contains(&number) && number.is_multiple_of(2);
    if fits {
        Ok(number)
    } else {
        Err(format!("{number} is not an even number of {} to {}", range.start(), range.end()))
    }
}
