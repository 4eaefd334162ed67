//! Stub.
pub mod eval;
pub mod record;
pub mod scene;
pub mod report;
pub mod design;
pub mod motion;
pub mod simulate;
