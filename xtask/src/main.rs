//! `cargo xtask <command>`: the developer's commands of the workspace.

mod cargo;
mod double;
mod elf;
mod emulator;
mod image;
mod table;
mod tally;
mod toolchain;

use std::io::{BufRead, BufReader};
use std::process::ExitCode;

use cargo::Cargo;
use image::{Counts, Trouble};
use tally::Tally;

const HELP: &str = "\
Developer commands of the workspace

Usage: cargo xtask <command>

  test         formatting, lints, every test of the workspace, the model's image; what CI runs
  lint         formatting and lints alone
  model-image  builds the model for a microcontroller, looks for double precision in it, runs it in an emulator: the same
               bits as here, as many instructions as recorded; with --record it records them
  help         this text

Formatting needs rustfmt and the lints need clippy; a step whose component is not installed is skipped and says so. The image
needs a toolchain for the microcontroller and qemu-system-arm; without them `test` skips it, but not where CI is set.
Exit codes: that of the first step that fails; 2 for a wrong command line.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["test"] => lint().and_then(|()| test()),
        ["lint"] => lint(),
        ["model-image"] => model_image(Counts::Compare),
        ["model-image", "--record"] => model_image(Counts::Record),
        ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            Ok(())
        }
        _ => {
            eprintln!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(code) => ExitCode::from(code),
    }
}

/// Formatting and lints, as far as their components are installed; the exit code of the first that fails.
fn lint() -> Result<(), u8> {
    step("fmt", &["fmt", "--all", "--check"])?;
    step("clippy", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])
}

fn step(component: &str, arguments: &[&str]) -> Result<(), u8> {
    if !Cargo::has(component) {
        println!("xtask: skipped, `cargo {component}` is not installed");
        return Ok(());
    }
    Cargo::announce(arguments).run()
}

/// All tests, then the image. The last line printed is the sum of the tests.
fn test() -> Result<(), u8> {
    let mut tally = Tally::default();
    let outcome = tests(&mut tally).and_then(|()| image_where_possible());
    println!("{tally}");
    outcome
}

fn tests(tally: &mut Tally) -> Result<(), u8> {
    let mut running = Cargo::announce(&["test", "--workspace"]).start()?;
    if let Some(output) = running.stdout.take() {
        // Bytes, because a test may print what is not UTF-8.
        for line in BufReader::new(output).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            println!("{line}");
            tally.read(&line);
        }
    }
    cargo::finish(&mut running)
}

/// The image as part of the tests: a missing tool is no failure, but in continuous integration, where it would never be noticed.
fn image_where_possible() -> Result<(), u8> {
    match image::check(Counts::Compare) {
        Err(Trouble::Missing(cure)) if std::env::var_os("CI").is_none_or(|ci| ci.is_empty()) => {
            println!(
                "xtask: skipped of the model's image (`cargo xtask model-image`) what needs a missing tool: {cure}"
            );
            Ok(())
        }
        other => told(other),
    }
}

fn model_image(counts: Counts) -> Result<(), u8> {
    told(image::check(counts))
}

fn told(outcome: Result<(), Trouble>) -> Result<(), u8> {
    outcome.map_err(|(Trouble::Missing(text) | Trouble::Failed(text))| {
        eprintln!("xtask: {text}");
        1
    })
}
