//! The table of `docs/evidence/validation.md`.

use softlimb::comparison::{Comparison, percent};

/// The lines a page's table stands between.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab validation -->", "<!-- end -->"];

/// The table in Markdown.
pub fn page(comparison: &Comparison) -> String {
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
