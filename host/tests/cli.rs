//! The command as a new user meets it: the binary itself, good and bad input, exit codes, and what it leaves behind.

#[path = "cli/desk.rs"]
mod desk;
#[path = "cli/eval.rs"]
mod eval;
#[path = "cli/files.rs"]
mod files;
#[path = "cli/finite_elements.rs"]
mod finite_elements;
#[path = "cli/labels.rs"]
mod labels;
#[path = "cli/output.rs"]
mod output;
#[path = "cli/run.rs"]
mod run;
#[path = "cli/scenes.rs"]
mod scenes;
#[path = "cli/trials.rs"]
mod trials;
#[path = "cli/usage.rs"]
mod usage;
