//! The laboratory's command line.

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use softlimb::cli::{finish, with_negative_numbers};

use crate::{accuracy, control, design, faults, measured, payload, statics, truth, validation};

#[derive(Parser)]
#[command(name = "softlimb-lab", version, about = "Compare methods and write the pages of evidence")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Accuracy(accuracy::Command),
    Choice(accuracy::choice::Command),
    Validation(validation::Validation),
    Bundles(validation::Bundles),
    Control(control::Control),
    Design(design::Design),
    Faults(faults::Faults),
    Measured(measured::Measured),
    Payload(payload::Payload),
    Statics(statics::Statics),
    Truth(truth::Truth),
}

/// Parses the command line, runs a verb, and returns its exit code.
pub fn main() -> ExitCode {
    let parsed = with_negative_numbers(Arguments::command()).try_get_matches();
    let parsed = parsed.and_then(|matches| Arguments::from_arg_matches(&matches));
    finish(parsed.map(|arguments| match arguments.verb {
        Verb::Accuracy(verb) => verb.run(),
        Verb::Choice(verb) => verb.run(),
        Verb::Validation(verb) => verb.run(),
        Verb::Bundles(verb) => verb.run(),
        Verb::Control(verb) => verb.run(),
        Verb::Design(verb) => verb.run(),
        Verb::Faults(verb) => verb.run(),
        Verb::Measured(verb) => verb.run(),
        Verb::Payload(verb) => verb.run(),
        Verb::Statics(verb) => verb.run(),
        Verb::Truth(verb) => verb.run(),
    }))
}
