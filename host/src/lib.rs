//! Stub.
pub mod record;
