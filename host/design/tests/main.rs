//! Tests of design, one module a subject.

mod bundle_effort;
mod bundle_files;
mod bundle_unlike;
mod design;
mod design_path;
mod design_scene;
mod design_series;
mod loaded;
#[path = "../../../tests/support/samples.rs"]
mod samples;
