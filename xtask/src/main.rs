//! `cargo xtask <command>`: the developer's commands of the workspace.

mod cargo;
mod tally;

use std::io::{BufRead, BufReader};
use std::process::ExitCode;

use cargo::Cargo;
use tally::Tally;

const HELP: &str = "\
Developer commands of the workspace

Usage: cargo xtask <command>

  test   formatting, lints, then every test of the workspace; what CI runs
  lint   formatting and lints alone
  help   this text

Formatting needs rustfmt and the lints need clippy; a step whose component is not installed is skipped and says so.
Exit codes: that of the first step that fails; 2 for a wrong command line.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["test"] => lint().and_then(|()| test()),
        ["lint"] => lint(),
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

/// All tests. The last line printed is their sum.
fn test() -> Result<(), u8> {
    let mut running = Cargo::announce(&["test", "--workspace"]).start()?;
    let mut tally = Tally::default();
    if let Some(output) = running.stdout.take() {
        // Bytes, because a test may print what is not UTF-8.
        for line in BufReader::new(output).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            println!("{line}");
            tally.read(&line);
        }
    }
    let outcome = cargo::finish(&mut running);
    println!("{tally}");
    outcome
}
