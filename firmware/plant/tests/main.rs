//! Tests of the plant, one binary.

mod common;
mod faults_and_settings;
mod plant;
