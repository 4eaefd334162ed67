//! Assessment of a run: figures of merit, a table for the terminal, an interactive page, a static one, and an animated picture.
//!
//! Everything here is a pure function of a [`RunLog`](crate::record::RunLog); no file
//! is read or written, nothing is printed.

mod causes;
mod charts;
mod facts;
mod motion;
mod moving;
mod projection;
mod rows;
mod stats;
mod still;
mod summary;
mod table;
mod tip;
mod verdict;

pub use motion::motion_svg;
pub use moving::{LIMB_SCRIPT, STYLE, html};
pub use stats::ErrorStats;
pub use still::still_html;
pub use summary::{Miss, ModuleSummary, PressureSummary, Summary, TipSummary, summary};

/// A template with its data. All names end in .html: everything but drawings, scripts and styles is escaped.
fn rendered(name: &str, data: &impl serde::Serialize) -> String {
    const TEMPLATES: [(&str, &str); 5] = [
        ("page.html", include_str!("moving/page.html")),
        ("still.html", include_str!("still.html")),
        ("head.html", include_str!("head.html")),
        ("summary.html", include_str!("summary.html")),
        ("facts.html", include_str!("facts.html")),
    ];
    let mut templates = minijinja::Environment::new();
    let added = TEMPLATES.into_iter().try_for_each(|(name, text)| templates.add_template(name, text));
    let rendered =
        added.and_then(|()| templates.get_template(name)).and_then(|page| page.render(minijinja::value::Serde(data)));
    rendered.expect("the templates are part of the program and every test renders them")
}
