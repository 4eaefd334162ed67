//! Tests of scenes, one module a subject.

mod castable;
mod loaded_keys;
mod obstacle;
mod scene_arrangement;
mod scene_checks;
mod scene_errors;
mod scene_files;
mod scene_hostile;
mod scene_redesign;
mod scene_reference;
mod scene_refit;
mod scene_segments;
mod scene_support;
mod scene_values;
