//! Tests of finite elements, one module a subject.

mod calculix;
mod fem;
mod meridian;
mod section;
