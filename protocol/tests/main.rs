//! Tests of the link, one binary.

mod common;
mod robustness;
mod roundtrip;
mod session;
mod spec;
mod vectors;
