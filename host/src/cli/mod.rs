//! The command line: one file per verb. The only room that prints and that knows exit codes.
//!
//! Results go to standard output, talk to standard error. Exit codes: 0 done, 1 failed, 2 the command line is wrong,
//! 3 done with warnings.

mod calibrate;
mod check;
mod design;
mod eval;
mod fabricate;
mod failure;
mod fem;
mod kept;
mod payload;
mod report;
mod run;
mod statics;
mod tolerance;
mod trials;
mod workspace;
mod workspace_loaded;

use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub use failure::Failure;
pub use kept::{read, write};

/// Parts of `fem compare` that the laboratory shares.
pub mod fea {
    pub use super::fem::{Calculix, as_json, text};
}

/// How a verb ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Done,
    /// Done, with warnings printed.
    DoneWithWarnings,
}

#[derive(Parser)]
#[command(
    name = "softlimb",
    version,
    about = "Design, simulate and run a limb of fiber-reinforced actuators",
    after_help = "Exit codes: 0 done, 1 failed, 2 wrong command line, 3 done with warnings.\n\
                  Start here: softlimb run scenes/pick-and-place-a.toml"
)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Check(check::Check),
    Design(design::Design),
    Eval(eval::Eval),
    Run(run::Run),
    Report(report::Report),
    Fem(fem::Fem),
    Fabricate(fabricate::Fabricate),
    Calibrate(calibrate::Calibrate),
    Payload(payload::Payload),
    Workspace(workspace::Workspace),
    Statics(statics::Statics),
    Tolerance(tolerance::Tolerance),
    Trials(trials::Trials),
}

/// Parses the command line, runs a verb, and returns its exit code.
pub fn main() -> ExitCode {
    finish(Arguments::try_parse().map(|arguments| match arguments.verb {
        Verb::Check(verb) => verb.run(),
        Verb::Design(verb) => verb.run(),
        Verb::Eval(verb) => verb.run(),
        Verb::Run(verb) => verb.run(),
        Verb::Report(verb) => verb.run(),
        Verb::Fem(verb) => verb.run(),
        Verb::Fabricate(verb) => verb.run(),
        Verb::Calibrate(verb) => verb.run(),
        Verb::Payload(verb) => verb.run(),
        Verb::Workspace(verb) => verb.run(),
        Verb::Statics(verb) => verb.run(),
        Verb::Tolerance(verb) => verb.run(),
        Verb::Trials(verb) => verb.run(),
    }))
}

/// The exit code of a parsed command line that ran, or of one that could not be parsed.
pub fn finish(outcome: Result<Result<Outcome, Failure>, clap::Error>) -> ExitCode {
    match outcome {
        Err(error) => {
            let wrong = error.use_stderr();
            // Nothing is left to do if the terminal is gone.
            let _ = error.print();
            if wrong { ExitCode::from(2) } else { ExitCode::SUCCESS }
        }
        Ok(Ok(Outcome::Done)) => ExitCode::SUCCESS,
        Ok(Ok(Outcome::DoneWithWarnings)) => ExitCode::from(3),
        Ok(Err(failure)) => {
            failure.print();
            ExitCode::from(failure.code())
        }
    }
}

/// Prints a result. A reader that has seen enough is no failure.
pub fn say(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    let written = writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Talks to the user on standard error. Where nobody listens there is nobody to tell either.
pub fn note(text: &str) {
    let _ = writeln!(stderr().lock(), "{text}");
}

/// Writes warnings to standard error; an outcome with any is one with warnings.
pub(crate) fn warn(warnings: &[String]) -> Outcome {
    warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    if warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings }
}

/// Whether messages on standard error may be coloured.
pub fn colour() -> bool {
    stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
