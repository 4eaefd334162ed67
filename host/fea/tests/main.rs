//! Tests of finite elements, one module a subject.

mod calculix;
mod fem;
mod meridian;
#[path = "../../../tests/support/samples.rs"]
mod samples;
mod section;
