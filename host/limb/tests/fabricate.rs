//! Sheets, paths, molds and tolerances.

mod advice;
mod common;
mod ends;
mod molds;
mod paths;
mod refusals;
mod second;
mod segments;
mod sheets;
mod surface;
mod threads;
