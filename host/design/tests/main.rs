//! Tests of design, one module a subject.

mod bundle_effort;
mod bundle_files;
mod bundle_unlike;
mod design;
mod design_path;
mod design_scene;
mod loaded;
#[path = "../../../tests/support/samples.rs"]
mod samples;
