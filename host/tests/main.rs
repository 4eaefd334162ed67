//! Tests of the command, one module a subject.

mod calibrate_command;
mod cli;
mod design_command;
mod design_evaluate;
mod eval_all;
mod eval_auto;
mod eval_batch;
mod eval_lines;
mod eval_order;
mod eval_reference;
mod eval_section;
mod eval_series;
mod eval_two_windings;
#[cfg(unix)]
mod fem_command;
mod mass_command;
mod payload_command;
mod readme;
#[allow(dead_code)]
#[path = "../../tests/support/samples.rs"]
mod samples;
mod steering_command;
mod sweep_command;
mod tolerance_command;

// Fixtures of other crates, of which each user takes a part.
#[cfg(unix)]
#[allow(dead_code)]
#[path = "../fea/tests/fem/fake.rs"]
mod fake;
#[cfg(unix)]
#[allow(dead_code)]
#[path = "../fea/tests/fem/sample.rs"]
mod sample;
#[path = "../limb/tests/tolerance/text.rs"]
mod tolerance_text;
#[allow(dead_code)]
#[path = "../rig/tests/calibrate/tube.rs"]
mod tube;
