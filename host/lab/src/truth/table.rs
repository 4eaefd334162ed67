//! The table of `docs/evidence/truth.md`.

use super::Row;

/// The lines a page's table stands between.
pub(crate) const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab truth -->", "<!-- end -->"];

/// The table in Markdown, without its lines.
pub(crate) fn heading(iterations: u32) -> String {
    format!(
        "\nTip error, mm, on the simulated limb of the scene's seed, before and after {iterations} iterations of learning:\n\n\
         | scene | simulated limb | RMSE at dwells | max at dwells | RMSE, whole way | learned: RMSE at dwells | max at dwells | RMSE, whole way |\n\
         | --- | --- | --: | --: | --: | --: | --: | --: |"
    )
}

/// A line of the table.
pub(crate) fn line(row: &Row) -> String {
    let cells = |figures: Option<[f64; 3]>| {
        let found = figures.map(|found| found.map(|m| format!("{:.2}", 1e3 * m)));
        found.unwrap_or(["falls".to_owned(), "-".to_owned(), "-".to_owned()]).join(" | ")
    };
    format!("| {} | {} | {} | {} |", row.scene, row.limb, cells(row.by_model), cells(row.learned))
}
