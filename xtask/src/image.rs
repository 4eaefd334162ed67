//! The image of the model for a microcontroller: what must not be in it, whether it answers as this computer does, what it costs.

mod counts;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::cargo::{Cargo, root, target_folder};
use crate::double::is_double;
use crate::table::{self, Row};
use crate::toolchain::{TARGET, Toolchain};
use crate::{elf, emulator, firmware};

const PACKAGE: &str = "softlimb-image-mps2-an386";

/// What to do where the toolchain for the microcontroller cannot lint.
const NO_CLIPPY: &str = "install clippy (`rustup component add clippy`, Debian: apt-get install rust-web-clippy) for";

/// Why the check did not end well.
pub(crate) enum Trouble {
    /// A tool is not installed; what to do.
    Missing(String),
    /// The check found this.
    Failed(String),
}

/// What to do with the instruction counts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counts {
    /// Compare them with the recorded ones.
    Compare,
    /// Record them.
    Record,
}

/// Builds the image, looks for double precision in it, runs it in the emulator and compares.
///
/// # Errors
/// The first step that fails.
pub(crate) fn check(counts: Counts) -> Result<(), Trouble> {
    let emulator = emulator::find();
    let toolchain = Toolchain::find().map_err(|cure| {
        let cures = [Some(cure), emulator.clone().err()];
        Trouble::Missing(cures.into_iter().flatten().collect::<Vec<_>>().join("\n"))
    })?;
    let image = built(&toolchain).map_err(Trouble::Failed)?;
    println!("xtask: no double precision in the model's image");
    emulator.map_err(Trouble::Missing)?;
    emulated(&image, &toolchain, counts).map_err(Trouble::Failed)
}

/// Lints what is compiled for microcontrollers only, by the toolchain that compiles it.
///
/// # Errors
/// A warning; that toolchain has no clippy.
pub(crate) fn lint() -> Result<(), Trouble> {
    let toolchain = Toolchain::find().map_err(Trouble::Missing)?;
    for package in [PACKAGE, firmware::PACKAGE] {
        let command = toolchain.lint(package, &target_folder().join("lint"));
        let mut command = command.ok_or_else(|| Trouble::Missing(format!("{NO_CLIPPY} {}", toolchain.version)))?;
        println!("xtask: clippy of {package} for {TARGET}, {}", toolchain.version);
        command.args(["--", "-D", "warnings"]).current_dir(root());
        let status = command.status().map_err(|error| Trouble::Failed(format!("cannot run cargo-clippy: {error}")))?;
        if !status.success() {
            return Err(Trouble::Failed(format!("warnings in {package}")));
        }
    }
    Ok(())
}

/// Builds the images and looks at their symbols; the model's image.
fn built(toolchain: &Toolchain) -> Result<PathBuf, String> {
    let folder = build(toolchain)?;
    if double_precision(&folder.join("double"))?.is_empty() {
        return Err("the check for double precision finds none in the image made for it to be found in".to_owned());
    }
    let image = folder.join("model");
    let found = double_precision(&image)?;
    if found.is_empty() {
        return Ok(image);
    }
    Err(format!("the model computes in double precision, in software:\n  {}", found.join("\n  ")))
}

/// Compares what the image answers, and what that costs.
fn emulated(image: &Path, toolchain: &Toolchain, counts: Counts) -> Result<(), String> {
    let rows = counts::converted(table::read(&emulator::run(image)?)?)?;
    compare(&rows, &answers_here()?)?;
    println!("xtask: the emulated Cortex-M4F gives the same bits as this computer, {} answers", rows.len());
    counts::report(&rows, &toolchain.version, counts)
}

/// Builds all images of the package; the folder they are in.
fn build(toolchain: &Toolchain) -> Result<PathBuf, String> {
    let folder = target_folder().join("image");
    println!("xtask: {PACKAGE} for {TARGET}, {}", toolchain.version);
    let status = toolchain.build(PACKAGE, &folder).current_dir(root()).status();
    let status = status.map_err(|error| format!("cannot run cargo: {error}"))?;
    if status.success() { Ok(folder.join(TARGET).join("firmware")) } else { Err("the image does not build".to_owned()) }
}

/// Routines of double precision in an image that has a beginning, sorted.
fn double_precision(image: &Path) -> Result<Vec<String>, String> {
    let named = |error: String| format!("{}: {error}", image.display());
    let file = fs::read(image).map_err(|error| named(error.to_string()))?;
    let symbols = elf::symbols(&file).map_err(named)?;
    if !symbols.iter().any(|symbol| symbol == "main") {
        return Err(named("it has no `main`".to_owned()));
    }
    let mut found: Vec<String> = symbols.into_iter().filter(|symbol| is_double(symbol)).collect();
    found.sort();
    found.dedup();
    Ok(found)
}

/// The same questions answered by the same program on this computer.
fn answers_here() -> Result<Vec<Row>, String> {
    let mut command = Cargo::quiet(&["run", "--quiet", "--package", PACKAGE, "--bin", "model"]);
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| format!("cannot run cargo: {error}"))?;
    if !output.status.success() {
        return Err("the model does not answer on this computer".to_owned());
    }
    table::read(&String::from_utf8_lossy(&output.stdout))
}

/// Whether two tables have the same answers, bit by bit.
fn compare(emulated: &[Row], here: &[Row]) -> Result<(), String> {
    let answer = |row: &Row| Row { cost: None, ..row.clone() };
    if emulated.len() != here.len() || here.is_empty() {
        return Err(format!("{} answers in the emulator, {} on this computer", emulated.len(), here.len()));
    }
    let pairs = || emulated.iter().map(answer).zip(here.iter().map(answer));
    match pairs().find(|(one, other)| one != other) {
        Some((one, other)) => Err(format!("the emulator answers\n  {one:?}\nand this computer\n  {other:?}")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::compare;
    use crate::table::read;

    #[test]
    fn one_bit_makes_a_difference_and_the_cost_makes_none() {
        let emulated = read("rest\tbending\t12\t0\t-\t1\t2\n").unwrap();
        assert!(compare(&emulated, &read("rest\tbending\t-\t0\t-\t1\t2\n").unwrap()).is_ok());
        assert!(compare(&emulated, &read("rest\tbending\t-\t0\t-\t1\t3\n").unwrap()).is_err());
        assert!(compare(&emulated, &[]).is_err() && compare(&[], &[]).is_err());
    }
}
