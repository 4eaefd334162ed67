//! Cargo as a child process, at the root of the workspace.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Output, Stdio};

/// One call of Cargo, not yet started.
pub(crate) struct Cargo {
    command: Command,
}

impl Cargo {
    /// `cargo <arguments>`, printed as one would type it.
    pub(crate) fn announce(arguments: &[&str]) -> Self {
        println!("xtask: cargo {}", arguments.join(" "));
        Self { command: Self::quiet(arguments) }
    }

    /// The same without printing it, for what a step needs and whoever reads along does not.
    pub(crate) fn quiet(arguments: &[&str]) -> Command {
        let mut command = Command::new(Self::program());
        command.args(arguments).current_dir(root());
        command
    }

    /// Path of Cargo: of the running one, if there is one.
    pub(crate) fn program() -> OsString {
        std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"))
    }

    /// Whether `cargo <component>` exists: rustfmt and clippy are separate parts of a toolchain.
    pub(crate) fn has(component: &str) -> bool {
        let mut probe = Self::quiet(&[component, "--version"]);
        probe.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
    }

    /// Runs to the end; the exit code where it is not 0.
    pub(crate) fn run(mut self) -> Result<(), u8> {
        let status = self.command.status().map_err(|error| not_started(&error))?;
        code(status)
    }

    /// Runs to the end and keeps what it prints, standard error where `errors` leaves that.
    pub(crate) fn output(mut self, errors: Stdio) -> Result<Output, u8> {
        self.command.stderr(errors).output().map_err(|error| not_started(&error))
    }
}

fn not_started(error: &std::io::Error) -> u8 {
    eprintln!("xtask: cannot run cargo: {error}");
    1
}

/// The exit code of a child where it is not 0. One that a signal ended has none of its own: 1.
pub(crate) fn code(status: ExitStatus) -> Result<(), u8> {
    if status.success() {
        return Ok(());
    }
    Err(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1))
}

/// The workspace: the folder above this package.
pub(crate) fn root() -> PathBuf {
    // At run time where Cargo tells it, so that a moved checkout still works.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| OsString::from(env!("CARGO_MANIFEST_DIR")));
    let package = PathBuf::from(package);
    package.parent().map_or_else(|| package.clone(), PathBuf::from)
}

/// The folder of everything that is built.
pub(crate) fn target_folder() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    root().join(folder)
}
