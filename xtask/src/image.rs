//! The model and the controller on a microcontroller: what must not be in their images, whether they answer as this computer does, what
//! each answer costs.

mod counts;
mod limits;
mod thumb;
mod trace;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::cargo::{Cargo, root, target_folder};
use crate::double::is_double;
use crate::table::{self, Row};
use crate::toolchain::{PROFILE, TARGET, Toolchain};
use crate::trouble::Trouble;
use crate::{elf, emulator, firmware};

const PACKAGE: &str = "softlimb-image-mps2-an386";

/// Its programs that answer: the model, and the controller.
const IMAGES: [&str; 2] = ["model", "device"];

/// The profile that compiles the controller as it is compiled for a board: what is generic in it is compiled with the program.
const AS_FLASHED: &str = "as-flashed";

/// Advice where the toolchain for the microcontroller cannot lint.
const NO_CLIPPY: &str = "install clippy (`rustup component add clippy`, Debian: apt-get install rust-web-clippy) for";

/// Use of the instruction counts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counts {
    /// Compare them with the recorded ones.
    Compare,
    /// Record them.
    Record,
}

/// Builds the image, looks for double precision in it, runs it in the emulator and compares with the same programs on this computer:
/// those in the folder `here`, or else built for it.
///
/// # Errors
/// The first step that fails.
pub(crate) fn check(counts: Counts, here: Option<&Path>) -> Result<(), Trouble> {
    let emulator = emulator::find();
    let toolchain = Toolchain::find().map_err(|cure| {
        let cures = [Some(cure), emulator.clone().err()];
        Trouble::Missing(cures.into_iter().flatten().collect::<Vec<_>>().join("\n"))
    })?;
    let images = built(&toolchain).map_err(Trouble::Failed)?;
    println!("xtask: no double precision in the images of the model and of the controller");
    emulator.map_err(Trouble::Missing)?;
    emulated(&images, &toolchain, counts, here).map_err(Trouble::Failed)
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

/// Builds the images and looks at their symbols; those that answer.
fn built(toolchain: &Toolchain) -> Result<[PathBuf; 2], String> {
    let folder = build(toolchain, PROFILE, &["model", "double"])?;
    if double_precision(&folder.join("double"))?.is_empty() {
        return Err("the check for double precision finds none in the image made for it to be found in".to_owned());
    }
    let images = [folder.join("model"), build(toolchain, AS_FLASHED, &["device"])?.join("device")];
    for image in &images {
        let found = double_precision(image)?;
        if !found.is_empty() {
            let name = image.display();
            return Err(format!("{name} computes in double precision, in software:\n  {}", found.join("\n  ")));
        }
    }
    Ok(images)
}

/// Compares what the images answer, and what that costs.
fn emulated(images: &[PathBuf], toolchain: &Toolchain, counts: Counts, here: Option<&Path>) -> Result<(), String> {
    let mut rows = Vec::new();
    for (image, name) in images.iter().zip(IMAGES) {
        let found = counts::converted(table::read(&emulator::run(image)?)?)?;
        compare(&found, &answers_here(name, here)?)?;
        println!(
            "xtask: {name}: the emulated Cortex-M4F gives the same bits as this computer, {} answers",
            found.len()
        );
        rows.extend(table::worst(found));
    }
    let known = if counts == Counts::Compare { counts::with_recorded_cycles(&rows, &toolchain.version)? } else { None };
    let rows = match known {
        Some(rows) => rows,
        None => {
            let found = images.iter().map(|image| Ok(table::worst(counts::converted(traced(image)?)?)));
            found.collect::<Result<Vec<_>, String>>()?.concat()
        }
    };
    counts::report(&rows, &toolchain.version, counts)?;
    limits::check(&rows)
}

/// Answers of an image, with the cost of each by the board's timer and by the emulator's account of every instruction.
fn traced(image: &Path) -> Result<Vec<Row>, String> {
    let named = |error: std::io::Error| format!("{}: {error}", image.display());
    let file = fs::read(image).map_err(named)?;
    // Names of functions would make up most of the account.
    let anonymous = image.with_extension("anonymous");
    fs::write(&anonymous, elf::anonymous(&file)).map_err(named)?;
    let meter = trace::Meter::new(&file)?;
    let (text, stretches) = emulator::traced(&anonymous, |told| meter.read(told))?;
    counts::with_stretches(table::read(&text)?, &stretches)
}

/// Builds programs of the package with a profile; the folder they are in.
fn build(toolchain: &Toolchain, profile: &str, programs: &[&str]) -> Result<PathBuf, String> {
    let folder = target_folder().join("image");
    println!("xtask: {} of {PACKAGE} for {TARGET}, {}", programs.join(", "), toolchain.version);
    let mut command = toolchain.build(PACKAGE, profile, &folder);
    command.args(programs.iter().flat_map(|program| ["--bin", program])).current_dir(root());
    let status = command.status().map_err(|error| format!("cannot run cargo: {error}"))?;
    if status.success() { Ok(folder.join(TARGET).join(profile)) } else { Err("the image does not build".to_owned()) }
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
fn answers_here(name: &str, here: Option<&Path>) -> Result<Vec<Row>, String> {
    let mut command = match here {
        Some(folder) => Command::new(folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX))),
        None => Cargo::quiet(&["run", "--quiet", "--package", PACKAGE, "--bin", name]),
    };
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| format!("cannot run `{name}`: {error}"))?;
    if !output.status.success() {
        return Err(format!("`{name}` does not answer on this computer"));
    }
    table::read(&String::from_utf8_lossy(&output.stdout))
}

/// Whether two tables have the same answers, bit by bit.
fn compare(emulated: &[Row], here: &[Row]) -> Result<(), String> {
    let answer = |row: &Row| Row { cost: None, cycles: None, ..row.clone() };
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
