//! The Python package: source distribution and wheel, built by maturin, and its tests beside an installed wheel.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::cargo::{Cargo, root, target_folder};
use crate::trouble::Trouble;

/// The builder, by the range of versions in `pyproject.toml`.
const MATURIN: &str = "maturin>=1.10,<2";

const PYTHON: &str = "Python 3.10 or newer with `venv` and `pip`: `apt-get install python3 python3-venv`";
const INDEX: &str = "a package index (PyPI): without one `pip` installs nothing";

/// Sources of the wheel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sources {
    /// This folder, with what is compiled already.
    Here,
    /// The source distribution, as `pip` builds it where there is no wheel.
    Distribution,
}

/// Builds the wheel, and nothing else lies in its folder afterwards; its path.
///
/// # Errors
/// A tool is missing, or the package does not compile.
pub(crate) fn wheel(sources: Sources) -> Result<PathBuf, Trouble> {
    let tools = environment("tools", Reuse::Yes)?;
    install(&tools, &[MATURIN])?;
    let folder = folder("wheels");
    let mut build = match sources {
        Sources::Here => {
            let _ = fs::remove_dir_all(&folder);
            println!("xtask: maturin build --release --locked");
            let mut build = Command::new(tools.join("bin/maturin"));
            build.args(["build", "--release", "--locked", "--quiet", "--out"]).arg(&folder);
            build
        }
        Sources::Distribution => {
            let sources = distribution(&tools)?;
            let _ = fs::remove_dir_all(&folder);
            println!("xtask: pip wheel {}", sources.display());
            let mut build = Command::new(tools.join("bin/pip"));
            build.args(["wheel", "--quiet", "--disable-pip-version-check", "--no-deps", "--wheel-dir"]).arg(&folder);
            // The files of a distribution are dated 2006: beside built files of this folder, Cargo would take them for unchanged.
            build.arg(sources).env_remove("CARGO_TARGET_DIR");
            build
        }
    };
    build.current_dir(root());
    succeed(build, "the wheel does not build")?;
    only_file(&folder)
}

/// Builds the source distribution, and nothing else lies in its folder afterwards; its path.
fn distribution(tools: &Path) -> Result<PathBuf, Trouble> {
    let folder = folder("sdist");
    let _ = fs::remove_dir_all(&folder);
    println!("xtask: maturin sdist");
    let mut build = Command::new(tools.join("bin/maturin"));
    build.args(["sdist", "--out"]).arg(&folder).current_dir(root());
    succeed(build, "the source distribution does not build: it takes the files that git knows")?;
    only_file(&folder)
}

/// The file of a folder.
fn only_file(folder: &Path) -> Result<PathBuf, Trouble> {
    let files: Vec<_> = fs::read_dir(folder).map(|entries| entries.flatten().collect()).unwrap_or_default();
    let [file] = &files[..] else {
        return Err(Trouble::Failed(format!("{} holds {} files: one is expected", folder.display(), files.len())));
    };
    println!("xtask: {}", file.path().display());
    Ok(file.path())
}

/// Builds the wheel, installs it into a fresh environment, and runs its tests there.
///
/// # Errors
/// As [`wheel`]; a test fails.
pub(crate) fn test(sources: Sources) -> Result<(), Trouble> {
    let wheel = wheel(sources)?;
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
