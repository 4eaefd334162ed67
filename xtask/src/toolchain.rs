//! A way to build for the microcontroller with what is installed.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Cortex-M4 with its unit for single precision.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";

/// The profile of images.
pub(crate) const PROFILE: &str = "firmware";

/// Advice where there is none.
const CURE: &str = "\
no installed toolchain builds for thumbv7em-none-eabihf. Install one:
  with rustup:            rustup target add thumbv7em-none-eabihf
  Debian, without rustup: apt-get install rustc-web cargo-web rust-web-src lld";

/// A Cargo that can build for the target.
pub(crate) struct Toolchain {
    cargo: PathBuf,
    rustc: PathBuf,
    /// `rustc 1.96.0 (...)`.
    pub(crate) version: String,
    /// Whether only the source of the standard library of the target is installed.
    from_source: bool,
    /// Linker, if the toolchain brings none for the target.
    linker: Option<PathBuf>,
}

impl Toolchain {
    /// The first that will do, with the target installed or with the source of the standard library: the one that runs now, then those
    /// in the folders of PATH, Debian's among them.
    ///
    /// # Errors
    /// What to install.
    pub(crate) fn find() -> Result<Self, String> {
        let named = |variable: &str| env::var_os(variable).map(PathBuf::from);
        let cargo = named("CARGO").unwrap_or_else(|| PathBuf::from("cargo"));
        // Beside a Cargo that is named by its folder is its own compiler.
        let beside = cargo.parent().map(|folder| program(folder, "rustc")).filter(|rustc| rustc.is_file());
        let rustc = named("RUSTC").or(beside).unwrap_or_else(|| PathBuf::from("rustc"));
        let own = (cargo, rustc);
        let pairs = folders().into_iter().map(|folder| (program(&folder, "cargo"), program(&folder, "rustc")));
        let pairs = pairs.filter(|(cargo, rustc)| cargo.is_file() && rustc.is_file());
        let found = std::iter::once(own).chain(pairs).find_map(|(cargo, rustc)| Self::of(cargo, rustc));
        found.ok_or_else(|| CURE.to_owned())
    }

    fn of(cargo: PathBuf, rustc: PathBuf) -> Option<Self> {
        let version = answer(&rustc, "--version")?;
        if !is_new_enough(&version) {
            return None;
        }
        let library = PathBuf::from(answer(&rustc, "--print=sysroot")?).join("lib/rustlib");
        let installed = library.join(TARGET).join("lib").is_dir();
        let source = library.join("src/rust/library/core").is_dir();
        let own_linker = answer(&rustc, "--print=host-tuple").is_some_and(|host| has_linker(&library.join(host)));
        let linker = if own_linker { None } else { Some(system_linker()?) };
        (installed || source).then_some(Self { cargo, rustc, version, from_source: !installed, linker })
    }

    /// Folder of the compiler and the source of its library.
    pub(crate) fn sysroot(&self) -> Option<PathBuf> {
        answer(&self.rustc, "--print=sysroot").map(PathBuf::from)
    }

    /// `cargo build` of a package for the target into a folder, with a profile for images.
    pub(crate) fn build(&self, package: &str, profile: &str, folder: &Path) -> Command {
        let mut command = Command::new(&self.cargo);
        command.arg("build");
        self.aim(command, package, profile, folder)
    }

    /// `cargo clippy` in the same way, where this toolchain has one; another's does not know its library.
    pub(crate) fn lint(&self, package: &str, folder: &Path) -> Option<Command> {
        let clippy = program(self.cargo.parent()?, "cargo-clippy");
        let runs = |program: &Path| {
            let probe = Command::new(program)
                .args(["clippy", "--version"])
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status();
            probe.is_ok_and(|status| status.success())
        };
        if !runs(&clippy) {
            return None;
        }
        let mut command = Command::new(clippy);
        command.arg("clippy").env("CARGO", &self.cargo);
        Some(self.aim(command, package, PROFILE, folder))
    }

    /// A package, the target, a folder and what this toolchain needs for them.
    fn aim(&self, mut command: Command, package: &str, profile: &str, folder: &Path) -> Command {
        command.args(["--package", package, "--profile", profile, "--target", TARGET, "--target-dir"]);
        command.arg(folder).env("RUSTC", &self.rustc);
        // Flags for this computer are none for the microcontroller.
        command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
        if self.from_source {
            // Stable compilers build the standard library from source when asked like this.
            command.env("RUSTC_BOOTSTRAP", "1");
            command.args(["-Zbuild-std=core", "-Zbuild-std-features=compiler-builtins-mem"]);
        }
        if let Some(linker) = &self.linker {
            command.env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker);
        }
        command
    }
}

/// Output of a program for one argument; `None` where it does not run.
fn answer(program: &Path, argument: &str) -> Option<String> {
    let output = Command::new(program).arg(argument).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// Whether `rustc 1.96.0 ...` is the workspace's minimum or newer.
fn is_new_enough(version: &str) -> bool {
    let numbers = |text: &str| -> Option<(u32, u32)> {
        let mut parts = text.split('.').map(|part| part.parse().ok());
        Some((parts.next()??, parts.next()??))
    };
    let found = version.split_whitespace().nth(1).and_then(numbers);
    found.is_some() && found >= numbers(env!("CARGO_PKG_RUST_VERSION"))
}

fn has_linker(host_library: &Path) -> bool {
    ["bin/rust-lld", "bin/rust-lld.exe"].iter().any(|name| host_library.join(name).is_file())
}

/// The folders in which programs are looked for.
fn folders() -> Vec<PathBuf> {
    env::var_os("PATH").map(|path| env::split_paths(&path).collect()).unwrap_or_default()
}

fn program(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}{}", env::consts::EXE_SUFFIX))
}

/// `ld.lld` of the system, also under a name with its version.
fn system_linker() -> Option<PathBuf> {
    let folders = folders();
    let named = |name: &str| folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file());
    named("ld.lld").or_else(|| (14..40).rev().find_map(|version| named(&format!("ld.lld-{version}"))))
}

#[cfg(test)]
mod tests {
    use super::is_new_enough;

    #[test]
    fn versions_compare_as_numbers() {
        assert!(is_new_enough("rustc 1.100.0 (abc 2027-01-01)") && is_new_enough("rustc 2.0.0"));
        assert!(is_new_enough("rustc 1.89.0") && !is_new_enough("rustc 1.88.9 (abc)"));
        assert!(!is_new_enough("rustc 1.9.0") && !is_new_enough("rustc") && !is_new_enough(""));
    }
}
