//! The steps of `test` and `lint`: formatting, lints, every test, the images.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::thread;

use crate::cargo::{self, Cargo};
use crate::firmware::{self, Board, Sizes};
use crate::image::{self, Counts, Trouble};
use crate::tally::Tally;
use crate::{emulator, setup};

/// The variable that tells the tests where the images are.
const IMAGES: &str = "SOFTLIMB_IMAGES";

/// Formatting and lints, as far as their components are installed; the exit code of the first that fails.
pub(crate) fn lint(tally: &mut Tally) -> Result<(), u8> {
    step(tally, "fmt", &["fmt", "--all", "--check"])?;
    step(tally, "clippy", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])?;
    lint_images(tally)
}

fn step(tally: &mut Tally, component: &str, arguments: &[&str]) -> Result<(), u8> {
    if !Cargo::has(component) {
        let cure = format!("`cargo {component}` is not installed: `rustup component add {}`", package(component));
        return where_possible(tally, &format!("`cargo {component}`"), || Err(Trouble::Missing(cure)))
            .map(|_: Option<()>| ());
    }
    Cargo::announce(arguments).run()
}

/// The name under which a component of the toolchain is installed.
fn package(component: &str) -> &str {
    if component == "fmt" { "rustfmt" } else { component }
}

/// Everything a change must pass. The last lines printed name what was skipped and sum up the tests.
pub(crate) fn test(may_install: bool) -> Result<(), u8> {
    setup::prepare(may_install);
    let mut tally = Tally::default();
    let outcome = all(&mut tally);
    println!("{tally}");
    outcome
}

fn all(tally: &mut Tally) -> Result<(), u8> {
    lint(tally)?;
    let images = where_possible(tally, "images for the board", images)?;
    tests(tally, images.as_deref())?;
    where_possible(tally, "`cargo xtask model-image`", || image::check(Counts::Compare)).map(drop)
}

/// Builds the images that tests run in the emulator; where they are.
fn images() -> Result<PathBuf, Trouble> {
    emulator::find().map_err(Trouble::Missing)?;
    firmware::build(Board::F446, Sizes::Compare)?;
    firmware::build(Board::F405, Sizes::Compare).map(|_| firmware::folder())
}

/// Lints of what is compiled for the microcontroller only. A toolchain that builds for it need not bring any: that is no failure.
fn lint_images(tally: &mut Tally) -> Result<(), u8> {
    match image::lint() {
        Err(Trouble::Missing(cure)) => {
            println!("xtask: skipped, lints of the images: {cure}");
            tally.skip("lints of the images");
            Ok(())
        }
        other => told(other),
    }
}

/// All tests; with the folder of the images, those that run them too.
fn tests(tally: &mut Tally, images: Option<&Path>) -> Result<(), u8> {
    let running = Cargo::announce(&["test", "--workspace"]);
    let mut running = images.into_iter().fold(running, |cargo, images| cargo.with(IMAGES, images)).start()?;
    // Two streams, each passed on as it comes: what tests skip is told on the second.
    let errors = running.stderr.take().map(|errors| thread::spawn(|| pass_on(errors, std::io::stderr())));
    if let Some(output) = running.stdout.take() {
        tally.add(&pass_on(output, std::io::stdout()));
    }
    if let Some(Ok(skipped)) = errors.map(thread::JoinHandle::join) {
        tally.add(&skipped);
    }
    cargo::finish(&mut running)
}

/// Prints every line and reads it. Bytes, because a test may print what is not UTF-8.
fn pass_on(from: impl Read, mut to: impl Write) -> Tally {
    let mut tally = Tally::default();
    for line in BufReader::new(from).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        // Where nobody listens, the tests go on.
        let _ = writeln!(to, "{line}");
        tally.read(&line);
    }
    tally
}

/// A step that needs tools which are not part of Rust: that one is missing is no failure, but in continuous integration, where it would
/// never be noticed.
fn where_possible<T>(
    tally: &mut Tally,
    name: &str,
    step: impl FnOnce() -> Result<T, Trouble>,
) -> Result<Option<T>, u8> {
    match step() {
        Ok(done) => Ok(Some(done)),
        Err(Trouble::Missing(cure)) if !is_continuous_integration() => {
            println!("xtask: skipped, {name}: {cure}");
            tally.skip(name);
            Ok(None)
        }
        Err(trouble) => told(Err(trouble)).map(|()| None),
    }
}

fn is_continuous_integration() -> bool {
    std::env::var_os("CI").is_some_and(|ci| !ci.is_empty())
}

/// Says what is wrong; an exit code.
fn told(outcome: Result<(), Trouble>) -> Result<(), u8> {
    outcome.map_err(|(Trouble::Missing(text) | Trouble::Failed(text))| {
        eprintln!("xtask: {text}");
        1
    })
}

/// As [`told`], with a code of its own for a tool that is missing.
pub(crate) fn installed(outcome: Result<(), Trouble>) -> Result<(), u8> {
    let missing = matches!(outcome, Err(Trouble::Missing(_)));
    told(outcome).map_err(|code| if missing { 2 } else { code })
}
