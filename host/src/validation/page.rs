//! The table of `docs/evidence/validation.md`.

use super::compare::Comparison;
use super::table::percent;
use crate::marked;

/// The lines a page's table stands between.
pub const PLACE: [&str; 2] = ["<!-- written by softlimb fem compare -->", "<!-- end -->"];

/// Whether a document has a place for the table.
pub fn has_place(document: &str) -> bool {
    marked::has_place(document, PLACE)
}

/// A document with its table replaced by that of a comparison; `None` where it has no place for one.
pub fn refreshed(document: &str, comparison: &Comparison) -> Option<String> {
    marked::replaced(document, PLACE, &page(comparison))
}

fn page(comparison: &Comparison) -> String {
    let mut text = "\n| actuator | kPa | analytic | calibrated | CalculiX | error of the section |\n\
                    | --- | --- | --: | --: | --: | --: |\n"
        .to_owned();
    for line in comparison.lines() {
        let [low, high] = line.pressures_kpa;
        let cells = line.worst.map(percent);
        text += &format!("| {} | {low:.0}-{high:.0} | {} |\n", line.case, cells.join(" | "));
    }
    text.push('\n');
    text
}
