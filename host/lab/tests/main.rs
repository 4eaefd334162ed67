//! Tests of the laboratory, one module a subject.

mod bench_accuracy;
mod bundle;
mod choice;
mod command;
mod control;
mod design_compare;
mod faults;
mod measured;
mod validation;
