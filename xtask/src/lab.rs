//! The laboratory: its package, with the arguments of `cargo xtask lab`.

use std::env;

use crate::cargo::{Cargo, code, root};

const PACKAGE: &str = "softlimb-lab";

/// Runs the laboratory where the caller is, whose paths are among the arguments; its exit code where that is not 0.
pub(crate) fn run(arguments: &[&str]) -> Result<(), u8> {
    let mut command = Cargo::quiet(&["run", "--release", "--package", PACKAGE, "--bin", PACKAGE, "--manifest-path"]);
    command.arg(root().join("Cargo.toml")).arg("--").args(arguments);
    if let Ok(folder) = env::current_dir() {
        command.current_dir(folder);
    }
    let status = command.status().map_err(|error| {
        eprintln!("xtask: cannot run cargo: {error}");
        1
    })?;
    code(status)
}
