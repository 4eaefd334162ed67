//! The table of `docs/evidence/truth.md`.

use super::Row;

/// The lines a page's table stands between.
pub(crate) const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab truth -->", "<!-- end -->"];

/// The table in Markdown, without its lines.
pub(crate) fn heading(iterations: u32) -> String {
    format!(
        "\nTip error, mm, on the simulated limb of the scene's seed, before and after {iterations} iterations of learning, and with feedback \
         within the run in place of learning:\n\n\
         | scene | simulated limb | RMSE at dwells | max at dwells | RMSE, whole way | learned: RMSE at dwells | max at dwells | RMSE, whole way | feedback: RMSE at dwells | max at dwells | RMSE, whole way |\n\
         | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |"
    )
}

/// A line of the table.
pub(crate) fn line(row: &Row) -> String {
    let cells = |figures: Option<[f64; 3]>| {
        let found = figures.map(|found| found.map(|m| format!("{:.2}", 1e3 * m)));
        found.unwrap_or(["falls".to_owned(), "-".to_owned(), "-".to_owned()]).join(" | ")
    };
    let [by_model, learned, feedback] = [row.by_model, row.learned, row.feedback].map(cells);
    format!("| {} | {} | {by_model} | {learned} | {feedback} |", row.scene, row.limb)
}

/// The rows of a table, as it has them: rounded.
pub(crate) fn rows(text: &str) -> Vec<Row> {
    let figures = |cells: &[&str]| -> Option<[f64; 3]> {
        let mm: Option<Vec<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
        mm?.try_into().ok().map(|mm: [f64; 3]| mm.map(|mm| 1e-3 * mm))
    };
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [scene, limb, errors @ ..] = &cells[..] else { return None };
        let is_row = errors.len() == 9 && *scene != "scene" && !scene.starts_with("---");
        is_row.then(|| Row {
            scene: (*scene).to_owned(),
            limb: (*limb).to_owned(),
            by_model: figures(&errors[..3]),
            learned: figures(&errors[3..6]),
            feedback: figures(&errors[6..]),
        })
    };
    text.lines().filter(|line| line.starts_with('|')).filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::picture::picture;

    #[test]
    fn table_is_read_as_it_was_written() {
        let row = Row {
            scene: "arm".into(),
            limb: "body + creep".into(),
            by_model: Some([1.5e-3, 2e-3, 0.25e-3]),
            learned: None,
            feedback: Some([0.5e-3, 1e-3, 4e-3]),
        };
        let read = rows(&format!("{}\n{}", heading(3), line(&row)));
        assert_eq!((read.len(), line(&read[0]), read[0].learned), (1, line(&row), None));
        assert!(line(&row).ends_with("| falls | - | - | 0.50 | 1.00 | 4.00 |"), "{}", line(&row));
    }

    /// `SOFTLIMB_WRITE_TRUTH=1 cargo test -p softlimb-lab --lib truth` writes the picture anew from the table of the page.
    #[test]
    fn picture_shows_the_table_of_the_page() {
        let file = |name: &str| format!("{}/../../docs/evidence/{name}", env!("CARGO_MANIFEST_DIR"));
        let page = std::fs::read_to_string(file("truth.md")).unwrap();
        let drawn = picture(&rows(&page));
        if std::env::var_os("SOFTLIMB_WRITE_TRUTH").is_some() {
            std::fs::write(file("truth.svg"), &drawn).unwrap();
        }
        assert!(
            drawn == std::fs::read_to_string(file("truth.svg")).unwrap(),
            "docs/evidence/truth.svg is not of the table"
        );
    }
}
