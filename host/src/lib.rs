//! Stub.
pub mod record;
pub mod scene;
pub mod report;
