//! Sheets, paths, molds and tolerances.

#[path = "fabricate/common.rs"]
mod common;
#[path = "fabricate/molds.rs"]
mod molds;
#[path = "fabricate/paths.rs"]
mod paths;
#[path = "fabricate/refusals.rs"]
mod refusals;
#[path = "fabricate/sheets.rs"]
mod sheets;
#[path = "fabricate/surface.rs"]
mod surface;
