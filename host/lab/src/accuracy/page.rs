//! The tables of `docs/evidence/accuracy.md`.

use std::fmt::Write;

use super::report::{Report, Row, figure, significant};

/// The lines a page's tables stand between.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab accuracy -->", "<!-- end -->"];

/// The tables of a report in Markdown, one for each problem and motion, both scalars side by side.
pub fn page(report: &Report) -> String {
    let mut text = format!("\n{}.\n", report.heading());
    let mut groups: Vec<[&str; 2]> = Vec::new();
    for row in &report.rows {
        let group = [row.names[0].as_str(), row.names[2].as_str()];
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for [problem, motion] in groups {
        let _ = write!(
            text,
            "\n### {problem}, {motion}\n\n\
             | method | n | f64: max error | median | time | instructions | flops | f32: max error | median | time | instructions | flops | MCU | cycles |\n\
             | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n"
        );
        let here = |row: &&Row| row.names[0] == problem && row.names[2] == motion;
        let rows: Vec<&Row> = report.rows.iter().filter(here).collect();
        let mut methods: Vec<&str> = Vec::new();
        for row in &rows {
            if !methods.contains(&row.names[1].as_str()) {
                methods.push(&row.names[1]);
            }
        }
        for method in methods {
            let of = |scalar: &str| rows.iter().find(|row| row.names[1] == method && row.names[3] == scalar);
            let [double, single] = ["f64", "f32"].map(of);
            let asked = double.or(single).map_or(0, |row| row.accuracy.asked);
            let cells =
                [double, single].map(|row| row.map_or_else(|| "- | - | - | - | -".to_owned(), |row| cells(row)));
            let (mcu, cycles) = single.map_or((None, None), |row| row.cost.emulated());
            let (mcu, cycles) = (figure(mcu, 0), figure(cycles, 0));
            let _ = writeln!(text, "| {method} | {asked} | {} | {mcu} | {cycles} |", cells.join(" | "));
        }
    }
    text.push('\n');
    text
}

/// Errors and cost of a line. A share that found no answer stands beside the error.
fn cells(row: &Row) -> String {
    let accuracy = &row.accuracy;
    let missing = accuracy.asked - accuracy.solved;
    let missing = if missing > 0 { format!(" ({missing} unanswered)") } else { String::new() };
    let (instructions, flops) = row.cost.counted();
    let time = significant(row.cost.time);
    let (max, median) = (accuracy.max_error, accuracy.median_error);
    format!("{max:.1e}{missing} | {median:.1e} | {time} | {} | {}", figure(instructions, 0), figure(flops, 0))
}
