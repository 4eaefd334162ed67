//! Tests of files, one module a subject.

mod whole;
