//! The steps of `test` and `lint`: formatting, lints, every test, the images.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{env, io, thread};

use crate::cargo::{Cargo, root};
use crate::image;
use crate::pool::{self, Done, Job};
use crate::programs::{self, Built, Program};
use crate::tally::Tally;
use crate::trouble::Trouble;
use crate::{emulator, firmware, msrv, setup};

/// The variable that tells the tests where the images are.
const IMAGES: &str = "SOFTLIMB_IMAGES";

/// The variable that sizes the samples of the tests, and its value for whole samples.
const SAMPLES: (&str, &str) = ("SOFTLIMB_SAMPLES", "full");

/// The longest that a job may take without whole samples: several times what the longest takes on two idle cores.
const LIMIT: Duration = Duration::from_secs(30 * 60);

/// The same of tests that keep time by this computer's clock.
const LIMIT_IN_REAL_TIME: Duration = Duration::from_secs(10 * 60);

/// The longest that any job may take with whole samples.
const LIMIT_FULL: Duration = Duration::from_secs(5 * 60 * 60);

/// Steps that need more than Rust.
const BOARDS: &str = "images for the board";
const COUNTS: &str = "`cargo xtask model-image`";
const PYTHON: &str = "the Python package";

/// Exit codes of this program.
const FAILED: u8 = 1;
const MISSING: u8 = 2;

/// Permissions of `test`, and its extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Options {
    /// Missing tools may be installed.
    pub(crate) may_install: bool,
    /// The tests take whole samples in place of a tenth.
    pub(crate) full: bool,
}

impl Options {
    /// The options of `test`, in any order; `None` for others.
    pub(crate) fn read(words: &[&str]) -> Option<Self> {
        words.iter().try_fold(Self { may_install: true, full: false }, |options, &word| match word {
            "--no-install" => Some(Self { may_install: false, ..options }),
            "--full" => Some(Self { full: true, ..options }),
            _ => None,
        })
    }
}

/// Formatting and lints, as far as their components are installed.
pub(crate) fn lint() -> Result<(), u8> {
    let mut tally = Tally::default();
    lints(&mut tally);
    tally.outcome()
}

/// Everything a change must pass. The last lines printed name what was skipped and what failed, and sum up the tests.
pub(crate) fn test(options: Options) -> Result<(), u8> {
    setup::prepare(options.may_install);
    let mut tally = Tally::default();
    all(&mut tally, options);
    println!("{tally}");
    tally.outcome()
}

/// Every step, whatever becomes of those before.
fn all(tally: &mut Tally, options: Options) {
    // Asked before Cargo puts another build of this program in its place.
    let program = env::current_exe().unwrap_or_else(|_| PathBuf::from("xtask"));
    // Linking an image takes one core for a while: beside lints and build that costs no time.
    let (built, images) = thread::scope(|scope| {
        let images = scope.spawn(|| build_images(&program));
        lints(tally);
        optional(tally, "lints of the images", image::lint());
        optional(tally, "the oldest Rust", msrv::check());
        let built = programs::build().inspect_err(|_| tally.fail("build of the tests")).unwrap_or_default();
        (built, images.join().unwrap_or_else(|_| Err("their builder failed".to_owned())))
    });
    let images = match images {
        // Each is reported, whatever became of the other.
        Ok(done) => done.map(|done| end(tally, &done)) == [true; 2],
        Err(cure) => {
            missing(tally, BOARDS, &cure);
            false
        }
    };
    let in_real_time = in_real_time(&built, options.full, images);
    pool::all(jobs(&program, built, options.full, images), |done| {
        end(tally, &done);
    });
    for job in in_real_time {
        end(tally, &pool::run(job));
    }
}

/// Tests that keep time by this computer's clock, as devices and frames of a browser do: they run after all others, one program at a time.
const IN_REAL_TIME: [(&str, &str); 8] = [
    ("host/tests/main.rs", "cli::console::"),
    ("host/tests/main.rs", "cli::device::"),
    ("host/tests/main.rs", "cli::jog::"),
    ("host/tests/main.rs", "cli::waiting::"),
    ("host/tests/main.rs", "cli::wire::"),
    ("host/rig/tests/main.rs", "port::"),
    ("host/rig/tests/main.rs", "report_browser::"),
    ("tests/emulated.rs", "wire::"),
];

fn in_real_time(built: &Built, full: bool, images: bool) -> Vec<Job> {
    let of = |(source, filter): (&str, &str)| {
        let test = built.tests.iter().find(|test| test.source == source)?;
        let mut job = program_job(test);
        job.name = format!("{source}, {filter}");
        job.command.args([filter, "--test-threads", "1"]);
        let mut job = with_settings(job, full, images);
        job.limit = Some(if full { LIMIT_FULL } else { LIMIT_IN_REAL_TIME });
        Some(job)
    };
    IN_REAL_TIME.into_iter().filter_map(of).collect()
}

/// A test program in its package's folder, as Cargo runs it.
fn program_job(test: &Program) -> Job {
    let mut command = Command::new(&test.file);
    command.current_dir(&test.folder).env("CARGO_MANIFEST_DIR", &test.folder);
    Job { name: test.source.clone(), command, limit: None }
}

fn with_settings(mut job: Job, full: bool, images: bool) -> Job {
    if images {
        job.command.env(IMAGES, firmware::folder());
    }
    job.limit = Some(if full { LIMIT_FULL } else { LIMIT });
    if full {
        job.command.env(SAMPLES.0, SAMPLES.1);
    }
    job
}

fn lints(tally: &mut Tally) {
    step(tally, "fmt", &["fmt", "--all", "--check"]);
    step(tally, "clippy", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]);
    // The command without what can be left out. What does not depend on it is not checked again.
    let without = ["clippy", "--workspace", "--all-targets", "--no-default-features", "--", "-D", "warnings"];
    step(tally, "clippy", &without);
}

/// A step by a component of the toolchain.
fn step(tally: &mut Tally, component: &str, arguments: &[&str]) {
    let name = format!("`cargo {component}`");
    if !Cargo::has(component) {
        let cure = format!("{name} is not installed: `rustup component add {}`", package(component));
        missing(tally, &name, &cure);
    } else if Cargo::announce(arguments).run().is_err() {
        tally.fail(&name);
    }
}

/// The name under which a component of the toolchain is installed.
fn package(component: &str) -> &str {
    if component == "fmt" { "rustfmt" } else { component }
}

/// Builds the images that tests run in the emulator; what to install where there is none.
fn build_images(program: &Path) -> Result<[Done; 2], String> {
    emulator::find()?;
    Ok(["f446", "f405"].map(|board| pool::run(own(program, BOARDS, &["firmware", "--board", board]))))
}

/// All that runs once everything is built, the longest first.
fn jobs(program: &Path, mut built: Built, full: bool, images: bool) -> Vec<Job> {
    let mut counts = own(program, COUNTS, &["model-image"]);
    if let Some(folder) = &built.programs {
        counts.command.arg("--here").arg(folder);
    }
    let examples = Cargo::quiet(&["test", "--doc"]);
    let examples = Job { name: "examples in the documentation".to_owned(), command: examples, limit: None };
    built.tests.sort_by_key(Program::place);
    let tests = built.tests.iter().map(|test| {
        let mut job = program_job(test);
        for (_, filter) in IN_REAL_TIME.into_iter().filter(|(source, _)| *source == test.source) {
            job.command.args(["--skip", filter]);
        }
        job
    });
    let python = own(program, PYTHON, &["wheel", "--sdist", "--test"]);
    let jobs = [counts, python, examples].into_iter().chain(tests);
    jobs.map(|job| with_settings(job, full, images)).collect()
}

/// A command of this program as a job of its own.
fn own(program: &Path, name: &str, arguments: &[&str]) -> Job {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root());
    Job { name: name.to_owned(), command, limit: None }
}

/// Prints what a job has printed, and reads it; whether the job succeeded.
fn end(tally: &mut Tally, done: &Done) -> bool {
    let name = &done.name;
    println!("\nxtask: {name}, {:.0} s", done.took.as_secs_f64());
    let output = match &done.output {
        Ok(output) => output,
        Err(error) => {
            eprintln!("xtask: cannot run {name}: {error}");
            tally.fail(name);
            return false;
        }
    };
    // Where nobody listens, the tests go on.
    let _ = io::stdout().write_all(&output.stdout);
    let _ = io::stderr().write_all(&output.stderr);
    for printed in [&output.stdout, &output.stderr] {
        String::from_utf8_lossy(printed).lines().for_each(|line| tally.read(line));
    }
    match output.status.code() {
        Some(0) => return true,
        Some(code) if code == i32::from(MISSING) && [BOARDS, COUNTS, PYTHON].contains(&name.as_str()) => {
            missing(tally, name, "a tool is missing")
        }
        Some(_) => tally.fail(name),
        None => {
            eprintln!("xtask: {name}: {}", output.status);
            tally.fail(name);
        }
    }
    false
}

/// A step that lacks a tool which is no part of Rust is no failure, but in continuous integration, where nobody would notice.
fn missing(tally: &mut Tally, name: &str, cure: &str) {
    if env::var_os("CI").is_some_and(|ci| !ci.is_empty()) {
        eprintln!("xtask: {name}: {cure}");
        tally.fail(name);
    } else {
        println!("xtask: skipped, {name}: {cure}");
        tally.skip(name);
    }
}

/// A step whose tools come with few toolchains: without them it is skipped everywhere.
fn optional(tally: &mut Tally, name: &str, outcome: Result<(), Trouble>) {
    match outcome {
        Ok(()) => {}
        Err(Trouble::Missing(cure)) => {
            println!("xtask: skipped, {name}: {cure}");
            tally.skip(name);
        }
        Err(Trouble::Failed(text)) => {
            eprintln!("xtask: {name}: {text}");
            tally.fail(name);
        }
    }
}

/// Says what is wrong; an exit code, of its own for a tool that is missing.
pub(crate) fn installed(outcome: Result<(), Trouble>) -> Result<(), u8> {
    let (text, code) = match outcome {
        Ok(()) => return Ok(()),
        Err(Trouble::Missing(text)) => (text, MISSING),
        Err(Trouble::Failed(text)) => (text, FAILED),
    };
    eprintln!("xtask: {text}");
    Err(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_come_in_any_order_and_others_are_refused() {
        let options = |may_install, full| Some(Options { may_install, full });
        assert_eq!(Options::read(&[]), options(true, false));
        assert_eq!(Options::read(&["--full", "--no-install"]), options(false, true));
        assert_eq!(Options::read(&["--no-install", "--full"]), options(false, true));
        assert_eq!(Options::read(&["--full", "fra-model"]), None);
    }

    #[test]
    fn tests_in_real_time_run_once_and_alone() {
        let test = |source: &str| Program { source: source.to_owned(), folder: "p".into(), file: "p/x".into() };
        let built = || Built { tests: vec![test("host/tests/main.rs"), test("host/src/lib.rs")], programs: None };
        let words = |job: &Job| job.command.get_args().map(|word| word.to_owned()).collect::<Vec<_>>();
        let alone = in_real_time(&built(), false, true);
        let of_room = |room: &str| [room, "--test-threads", "1"].map(std::ffi::OsString::from).to_vec();
        let rooms = ["cli::console::", "cli::device::", "cli::jog::", "cli::waiting::", "cli::wire::"];
        assert_eq!(alone.iter().map(words).collect::<Vec<_>>(), rooms.map(of_room));
        let beside = jobs(Path::new("xtask"), built(), false, true);
        let of = |name: &str| words(beside.iter().find(|job| job.name == name).unwrap());
        assert_eq!(of("host/tests/main.rs"), rooms.map(|room| ["--skip", room]).concat());
        assert!(of("host/src/lib.rs").is_empty());
    }

    #[test]
    fn whole_samples_and_images_are_told_to_every_test() {
        let test = |source: &str| Program { source: source.to_owned(), folder: "p".into(), file: "p/x".into() };
        let built = || Built { tests: vec![test("xtask/src/main.rs"), test("host/src/lib.rs")], programs: None };
        let of = |full, images| jobs(Path::new("xtask"), built(), full, images);
        let names: Vec<String> = of(false, false).into_iter().map(|job| job.name).collect();
        assert_eq!(names, [COUNTS, PYTHON, "examples in the documentation", "host/src/lib.rs", "xtask/src/main.rs"]);
        let has =
            |job: &Job, variable: &str| job.command.get_envs().any(|(name, value)| name == variable && value.is_some());
        for (full, images) in [(false, false), (false, true), (true, false), (true, true)] {
            for job in of(full, images) {
                assert_eq!((has(&job, SAMPLES.0), has(&job, IMAGES)), (full, images), "{}", job.name);
                assert!(job.limit.is_some(), "{}", job.name);
            }
        }
    }
}
