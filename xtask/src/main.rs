//! `cargo xtask <command>`: the developer's commands of the workspace.

mod cargo;
mod double;
mod elf;
mod emulator;
mod firmware;
mod image;
mod table;
mod tally;
mod toolchain;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use cargo::Cargo;
use firmware::{Board, Sizes};
use image::{Counts, Trouble};
use tally::Tally;

/// The variable that tells the tests where the images are.
const IMAGES: &str = "SOFTLIMB_IMAGES";

const HELP: &str = "\
Developer commands of the workspace

Usage: cargo xtask <command>

  test         formatting, lints, every test of the workspace, the model's image; what CI runs
  lint         formatting and lints alone
  model-image  builds the model for a microcontroller, looks for double precision in it, runs it in an emulator: the same
               bits as here, as many instructions as recorded; with --record it records them
  firmware     builds the image for a board, --board f446 (NUCLEO-F446RE, the default) or f405, as .elf, .bin and .hex, and its
               twin for the emulator; says how large it is, compared with what is recorded, and that nothing is in it that
               must not be; with --record it records the sizes
  flash        the same, and writes it into the board that is connected; --board as above
  help         this text

Formatting needs rustfmt and the lints need clippy; a step whose component is not installed is skipped and says so. The image
needs a toolchain for the microcontroller and qemu-system-arm; without them `test` skips it, but not where CI is set.
Exit codes: that of the first step that fails; 2 for a wrong command line, and where `firmware` or `flash` lack a tool.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["test"] => lint().and_then(|()| test()),
        ["lint"] => lint(),
        ["model-image"] => model_image(Counts::Compare),
        ["model-image", "--record"] => model_image(Counts::Record),
        ["firmware", ref options @ ..] => match board(options) {
            Some((board, sizes)) => installed(firmware::build(board, sizes).map(drop)),
            None => return usage(),
        },
        ["flash", ref options @ ..] => match board(options) {
            Some((board, Sizes::Compare)) => installed(firmware::flash(board)),
            _ => return usage(),
        },
        ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            Ok(())
        }
        _ => return usage(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(code) => ExitCode::from(code),
    }
}

fn usage() -> ExitCode {
    eprintln!("{HELP}");
    ExitCode::from(2)
}

/// The options of `firmware`, in any order; `None` for others.
fn board(options: &[&str]) -> Option<(Board, Sizes)> {
    match *options {
        [] => Some((Board::F446, Sizes::Compare)),
        ["--record"] => Some((Board::F446, Sizes::Record)),
        ["--board", name] => Some((Board::named(name)?, Sizes::Compare)),
        ["--board", name, "--record"] | ["--record", "--board", name] => Some((Board::named(name)?, Sizes::Record)),
        _ => None,
    }
}

/// As [`told`], with a code of its own for a tool that is missing.
fn installed(outcome: Result<(), Trouble>) -> Result<(), u8> {
    let missing = matches!(outcome, Err(Trouble::Missing(_)));
    told(outcome).map_err(|code| if missing { 2 } else { code })
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

/// The images, all tests, the model's image. The last line printed is the sum of the tests.
fn test() -> Result<(), u8> {
    let mut tally = Tally::default();
    let images = images_where_possible()?;
    let outcome = tests(&mut tally, images.as_deref()).and_then(|()| image_where_possible());
    println!("{tally}");
    outcome
}

/// All tests; with the folder of the images, those that run them too.
fn tests(tally: &mut Tally, images: Option<&Path>) -> Result<(), u8> {
    let running = Cargo::announce(&["test", "--workspace"]);
    let mut running = images.into_iter().fold(running, |cargo, images| cargo.with(IMAGES, images)).start()?;
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

/// Builds the images that tests run in the emulator; where they are. As for the model's image, a missing tool is a failure in
/// continuous integration only.
fn images_where_possible() -> Result<Option<PathBuf>, u8> {
    let built = firmware::build(Board::F405, Sizes::Compare).and_then(|_| emulator::find().map_err(Trouble::Missing));
    match built {
        Ok(()) => Ok(Some(firmware::folder())),
        Err(Trouble::Missing(cure)) if !is_continuous_integration() => {
            println!("xtask: skipped, the tests that say so below: {cure}");
            Ok(None)
        }
        Err(trouble) => told(Err(trouble)).map(|()| None),
    }
}

fn is_continuous_integration() -> bool {
    std::env::var_os("CI").is_some_and(|ci| !ci.is_empty())
}

/// The image as part of the tests: a missing tool is no failure, but in continuous integration, where it would never be noticed.
fn image_where_possible() -> Result<(), u8> {
    match image::check(Counts::Compare) {
        Err(Trouble::Missing(cure)) if !is_continuous_integration() => {
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
