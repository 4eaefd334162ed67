//! The table of `docs/evidence/accuracy.md` to choose a model by.

use softlimb::comparison::{Comparison, percent};

use super::measure::REFERENCE;
use super::{Choice, Summary};
use crate::accuracy::report::significant;

/// The lines a page's table stands between.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab choice -->", "<!-- end -->"];

/// The table in Markdown.
pub fn page(choice: &Choice, validation: &Comparison) -> String {
    let doubt = choice.rows.iter().map(|row| row.reference).fold(0.0, f64::max);
    let mut text = format!(
        "\n{} benders of seed {}. Reference: section FE with {} x {} elements, its own error at most {}.\n\n\
         | model | benders | error: median | largest | one answer | preparation | use it for |\n\
         | --- | --: | --: | --: | --: | --: | --- |\n",
        choice.rows.len(),
        choice.seed,
        REFERENCE.radial,
        REFERENCE.around,
        percent(Some(doubt)),
    );
    for Summary { model, count, errors, seconds } in choice.summaries(validation) {
        let [median, largest] = [0, 1].map(|index| percent(errors.map(|errors| errors[index])));
        let [answer, preparation] = [seconds.answer, seconds.preparation].map(time);
        let (name, purpose) = (model.name(), model.purpose());
        text += &format!("| {name} | {count} | {median} | {largest} | {answer} | {preparation} | {purpose} |\n");
    }
    text.push('\n');
    text
}

/// A time in the unit of its size.
fn time(seconds: Option<f64>) -> String {
    let Some(seconds) = seconds else { return "-".to_owned() };
    let units = [(1.0, "s"), (1e3, "ms"), (1e6, "us"), (1e9, "ns")];
    let (factor, unit) = units.into_iter().find(|(factor, _)| seconds * factor >= 1.0).unwrap_or(units[3]);
    format!("{} {unit}", significant(Some(seconds * factor)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_the_unit_of_their_size() {
        let texts = [Some(151.2), Some(2.34e-3), Some(9.1e-6), Some(4.4e-9), Some(2e-10), None].map(time);
        assert_eq!(texts, ["151 s", "2.3 ms", "9.1 us", "4.4 ns", "0.20 ns", "-"]);
    }
}
