//! Tests of the simulated device, one binary.

mod common;
mod device;
