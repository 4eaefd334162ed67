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
mod swing;
mod table;
mod tip;
mod verdict;

pub use motion::motion_svg;
pub use moving::{LIMB_SCRIPT, STYLE, html};
pub use stats::ErrorStats;
pub use still::still_html;
pub use summary::{Miss, ModuleSummary, PressureSummary, Summary, TipSummary, summary};

/// The page of a template that the compiler has checked.
fn rendered(page: &impl askama::Template) -> String {
    page.render().expect("a page is written to memory")
}
