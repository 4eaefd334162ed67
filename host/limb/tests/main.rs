//! Tests of the limb, one module a subject.

mod fabricate;
mod payload;
mod statics;
mod tolerance;
mod workspace;
