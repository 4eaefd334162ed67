//! Tests of the limb, one module a subject.

mod ends;
mod fabricate;
mod payload;
#[path = "../../../tests/support/samples.rs"]
mod samples;
mod statics;
mod steering;
mod tolerance;
mod workspace;
