//! The command as a new user meets it: the binary itself, good and bad input, exit codes, and what it leaves behind.

#[cfg(unix)]
mod console;
mod desk;
#[cfg(unix)]
mod device;
mod eval;
mod examples;
mod files;
mod finite_elements;
#[cfg(unix)]
mod jog;
mod labels;
mod learn;
mod logs;
mod materials;
mod output;
#[cfg(unix)]
mod pictures;
#[cfg(unix)]
mod program;
mod run;
mod scenes;
mod usage;
#[cfg(unix)]
mod waiting;
#[cfg(unix)]
mod wire;
