//! Tests of the laboratory, one module a subject.

mod bench_accuracy;
mod bundle;
mod command;
mod design_compare;
#[path = "../../../tests/support/samples.rs"]
mod samples;
mod validation;
