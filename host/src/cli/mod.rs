//! The command line: one file per verb. The only room that prints and that knows exit codes.
//!
//! Results go to standard output, messages to standard error. Exit codes: 0 done, 1 failed, 2 the command line is wrong,
//! 3 done with warnings.

#[cfg(any(feature = "console", feature = "terminal"))]
mod by_hand;
mod calibrate;
mod check;
mod check_margins;
mod check_swing;
mod completions;
#[cfg(feature = "console")]
mod console;
mod design;
mod device;
mod eval;
mod export;
mod fabricate;
mod failure;
pub mod fea;
mod interrupt;
#[cfg(feature = "terminal")]
mod jog;
mod learn;
mod man;
mod materials;
mod payload;
mod port;
mod record;
mod recover;
mod replay;
mod report;
mod retired;
mod run;
mod shared;
mod statics;
mod sweep;
mod tolerance;
mod waiting;
mod workspace;
mod workspace_loaded;

use std::any::TypeId;
use std::ffi::OsString;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Arg, Command, CommandFactory, FromArgMatches, Parser, Subcommand};

pub use design::refused;
pub use failure::Failure;
pub use shared::{read, write};
use waiting::Waiting;

/// End of a verb that did not fail.
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
    after_help = "Options take values with units: 60kPa, \"0.6 bar\". A plain number is in the unit that the help names.\n\
                  Exit codes: 0 done, 1 failed, 2 wrong command line, 3 done with warnings.\n\n\
                  Start here: softlimb run scenes/pick-and-place-a.toml"
)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Check(check::Check),
    Run(run::Run),
    Sweep(sweep::Sweep),
    #[cfg(feature = "terminal")]
    Jog(jog::Jog),
    #[cfg(feature = "console")]
    Console(console::Console),
    Report(report::Report),
    Replay(replay::Replay),
    Export(export::Export),
    Recover(recover::Recover),
    Record(record::Record),
    Device(device::Device),
    Eval(eval::Eval),
    Design(design::Design),
    Payload(payload::Payload),
    Calibrate(calibrate::Calibrate),
    Learn(learn::Learn),
    Materials(materials::Materials),
    Fea(fea::Fea),
    Workspace(workspace::Workspace),
    Statics(statics::Statics),
    Tolerance(tolerance::Tolerance),
    Fabricate(fabricate::Fabricate),
    Completions(completions::Completions),
    Man(man::Man),
}

impl Verb {
    /// Whether it shows nothing while it computes.
    fn is_silent(&self) -> bool {
        match self {
            #[cfg(feature = "terminal")]
            Self::Jog(_) => false,
            #[cfg(feature = "console")]
            Self::Console(_) => false,
            Self::Device(_) | Self::Record(_) | Self::Completions(_) | Self::Man(_) => false,
            // Its answers show as they come.
            Self::Eval(_) => !stdout().is_terminal(),
            _ => true,
        }
    }

    fn run(&self) -> Result<Outcome, Failure> {
        let _waiting = self.is_silent().then(Waiting::begin);
        match self {
            Self::Check(verb) => verb.run(),
            Self::Run(verb) => verb.run(),
            Self::Sweep(verb) => verb.run(),
            #[cfg(feature = "terminal")]
            Self::Jog(verb) => verb.run(),
            #[cfg(feature = "console")]
            Self::Console(verb) => verb.run(),
            Self::Report(verb) => verb.run(),
            Self::Replay(verb) => verb.run(),
            Self::Export(verb) => verb.run(),
            Self::Recover(verb) => verb.run(),
            Self::Record(verb) => verb.run(),
            Self::Device(verb) => verb.run(),
            Self::Eval(verb) => verb.run(),
            Self::Design(verb) => verb.run(),
            Self::Payload(verb) => verb.run(),
            Self::Calibrate(verb) => verb.run(),
            Self::Learn(verb) => verb.run(),
            Self::Materials(verb) => verb.run(),
            Self::Fea(verb) => verb.run(),
            Self::Workspace(verb) => verb.run(),
            Self::Statics(verb) => verb.run(),
            Self::Tolerance(verb) => verb.run(),
            Self::Fabricate(verb) => verb.run(),
            Self::Completions(verb) => verb.run(),
            Self::Man(verb) => verb.run(),
        }
    }
}

/// The grammar of the command.
pub fn command() -> Command {
    with_negative_numbers(Arguments::command())
}

/// Lets every option that is no path or name take a value that begins with a minus, so that its own range answers.
pub fn with_negative_numbers(command: Command) -> Command {
    let is_text = |arg: &Arg| {
        let of = arg.get_value_parser().type_id();
        of == TypeId::of::<PathBuf>() || of == TypeId::of::<String>()
    };
    let takes_numbers = move |arg: &Arg| !arg.is_positional() && arg.get_action().takes_values() && !is_text(arg);
    let lenient = move |arg: Arg| if takes_numbers(&arg) { arg.allow_hyphen_values(true) } else { arg };
    command.mut_args(lenient).mut_subcommands(with_negative_numbers)
}

/// Parses the command line, runs a verb, and returns its exit code.
pub fn main() -> ExitCode {
    main_of(std::env::args_os().collect()).into()
}

/// [`main`] with the words of a command line, the program's name before them.
pub fn main_of(words: Vec<OsString>) -> u8 {
    if let Some(failure) = retired::answer(&words) {
        return code(Ok(Err(failure)));
    }
    let parsed = command().try_get_matches_from(words);
    let parsed =
        parsed.and_then(|matches| Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command())));
    code(parsed.map(|arguments| arguments.verb.run()))
}

/// The exit code of a parsed command line that ran, or of one that could not be parsed.
pub fn finish(outcome: Result<Result<Outcome, Failure>, clap::Error>) -> ExitCode {
    code(outcome).into()
}

fn code(outcome: Result<Result<Outcome, Failure>, clap::Error>) -> u8 {
    match outcome {
        Err(error) => {
            let wrong = error.use_stderr();
            // Nothing is left to do if the terminal is gone.
            let _ = error.print();
            if wrong { 2 } else { 0 }
        }
        Ok(Ok(Outcome::Done)) => 0,
        Ok(Ok(Outcome::DoneWithWarnings)) => 3,
        Ok(Err(failure)) => {
            failure.print();
            failure.code()
        }
    }
}

/// Prints a result. A reader that has seen enough is no failure.
pub fn say(text: &str) -> Result<(), Failure> {
    let written = waiting::printing(|| {
        let mut out = stdout().lock();
        writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush())
    });
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a message to standard error. Where nobody listens there is nobody to tell either.
pub fn note(text: &str) {
    let _ = waiting::printing(|| writeln!(stderr().lock(), "{text}"));
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
