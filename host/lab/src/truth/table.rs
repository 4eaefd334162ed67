//! The table of `docs/evidence/truth.md`, and its golden file.

use std::fmt::Write;

use super::Row;

/// The lines a page's table stands between.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab truth -->", "<!-- end -->"];

/// The table in Markdown.
pub fn page(rows: &[Row], iterations: u32) -> String {
    let mut text = format!(
        "\nTip error, mm, on the simulated limb of the scene's seed, before and after {iterations} iterations of learning:\n\n\
         | scene | simulated limb | RMSE at dwells | max at dwells | RMSE, whole way | learned: RMSE at dwells | max at dwells | RMSE, whole way |\n\
         | --- | --- | --: | --: | --: | --: | --: | --: |\n"
    );
    for row in rows {
        let cells = |figures: Option<[f64; 3]>| {
            figures.map_or(["falls".to_owned(), "-".to_owned(), "-".to_owned()], |found| {
                found.map(|m| format!("{:.2}", 1e3 * m))
            })
        };
        let [before, after] = [cells(row.by_model), cells(row.learned)].map(|cells| cells.join(" | "));
        let _ = writeln!(text, "| {} | {} | {before} | {after} |", row.scene, row.limb);
    }
    text.push('\n');
    text
}

/// The table as tab-separated values, m.
pub fn tsv(rows: &[Row]) -> String {
    let mut text = "scene\tlimb\tdwell_rmse_m\tdwell_max_m\tway_rmse_m\tlearned_dwell_rmse_m\tlearned_dwell_max_m\tlearned_way_rmse_m\n".to_owned();
    for row in rows {
        let cells = |figures: Option<[f64; 3]>| {
            figures
                .map_or(["nan".to_owned(), "nan".to_owned(), "nan".to_owned()], |found| {
                    found.map(|m| format!("{m:.6}"))
                })
                .join("\t")
        };
        let _ = writeln!(text, "{}\t{}\t{}\t{}", row.scene, row.limb, cells(row.by_model), cells(row.learned));
    }
    text
}
