//! Tests of the simulated device, one binary.

mod common;
mod device;
mod log;
#[path = "../../../tests/support/samples.rs"]
mod samples;
mod supervision;
