//! Assessment of a run: numbers, a table for the terminal, a page with figures.
//!
//! Everything here is a pure function of a [`RunLog`](crate::record::RunLog); no file
//! is read or written, nothing is printed.

mod charts;
mod page;
mod rows;
mod stats;
mod summary;
mod table;
mod tip;

pub use page::html;
pub use stats::ErrorStats;
pub use summary::{Miss, ModuleSummary, PressureSummary, Summary, TipSummary, summary};
