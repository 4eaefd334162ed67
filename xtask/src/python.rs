//! The Python package: its wheel, built by maturin, and its tests beside an installed wheel.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::cargo::{Cargo, root, target_folder};
use crate::trouble::Trouble;

/// The builder, by the range of versions in `python/pyproject.toml`.
const MATURIN: &str = "maturin>=1.10,<2";

const PYTHON: &str = "Python 3.10 or newer with `venv` and `pip`: `apt-get install python3 python3-venv`";
const INDEX: &str = "a package index (PyPI): without one `pip` installs nothing";

/// Builds the wheel, and nothing else lies in its folder afterwards; its path.
///
/// # Errors
/// A tool is missing, or the package does not compile.
pub(crate) fn wheel() -> Result<PathBuf, Trouble> {
    let tools = environment("tools", Reuse::Yes)?;
    install(&tools, &[MATURIN])?;
    let folder = folder("wheels");
    let _ = fs::remove_dir_all(&folder);
    let mut build = Command::new(tools.join("bin/maturin"));
    build.args(["build", "--release", "--locked", "--quiet", "--manifest-path", "python/Cargo.toml", "--out"]);
    build.arg(&folder).current_dir(root());
    println!("xtask: maturin build --release --locked --manifest-path python/Cargo.toml");
    succeed(build, "the wheel does not build")?;
    let wheels: Vec<_> = fs::read_dir(&folder).map(|entries| entries.flatten().collect()).unwrap_or_default();
    let [wheel] = &wheels[..] else {
        return Err(Trouble::Failed(format!("{} holds {} files: a wheel is expected", folder.display(), wheels.len())));
    };
    println!("xtask: {}", wheel.path().display());
    Ok(wheel.path())
}

/// Builds the wheel, installs it into a fresh environment, and runs its tests there.
///
/// # Errors
/// As [`wheel`]; a test fails.
pub(crate) fn test() -> Result<(), Trouble> {
    let wheel = wheel()?;
    let fresh = environment("fresh", Reuse::No)?;
    install(&fresh, &[&format!("softlimb[test] @ file://{}", wheel.display())])?;
    // Not `python -m pytest`, which would find the source in place of the wheel.
    let mut tests = Command::new(fresh.join("bin/pytest"));
    tests.args(["-q", "python/tests"]).current_dir(root());
    succeed(tests, "the tests of the Python package fail")
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Reuse {
    Yes,
    No,
}

/// A virtual environment among the built files.
fn environment(name: &str, reuse: Reuse) -> Result<PathBuf, Trouble> {
    let path = folder(name);
    if reuse == Reuse::Yes && path.join("bin/pip").exists() {
        return Ok(path);
    }
    let made = Command::new("python3").args(["-m", "venv", "--clear"]).arg(&path).stdin(Stdio::null()).output();
    match made {
        Ok(output) if output.status.success() => Ok(path),
        _ => Err(Trouble::Missing(PYTHON.to_owned())),
    }
}

fn folder(name: &str) -> PathBuf {
    target_folder().join("python").join(name)
}

fn install(environment: &Path, requirements: &[&str]) -> Result<(), Trouble> {
    println!("xtask: pip install {}", requirements.join(" "));
    let mut pip = Command::new(environment.join("bin/pip"));
    pip.args(["install", "--quiet", "--disable-pip-version-check"]).args(requirements);
    match pip.stdin(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(Trouble::Missing(INDEX.to_owned())),
    }
}

fn succeed(mut command: Command, failure: &str) -> Result<(), Trouble> {
    // A build calls the same Cargo as this program.
    command.stdin(Stdio::null()).env("CARGO", Cargo::program());
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(Trouble::Failed(failure.to_owned())),
        Err(error) => Err(Trouble::Failed(format!("{failure}: {error}"))),
    }
}
