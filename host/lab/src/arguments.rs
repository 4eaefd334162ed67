//! The laboratory's command line.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use softlimb::cli::finish;

use crate::{accuracy, design, payload, validation};

#[derive(Parser)]
#[command(name = "softlimb-lab", version, about = "Compare methods and write the pages of evidence")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Accuracy(accuracy::Command),
    Validation(validation::Validation),
    Design(design::Design),
    Payload(payload::Payload),
}

/// Parses the command line, runs a verb, and returns its exit code.
pub fn main() -> ExitCode {
    finish(Arguments::try_parse().map(|arguments| match arguments.verb {
        Verb::Accuracy(verb) => verb.run(),
        Verb::Validation(verb) => verb.run(),
        Verb::Design(verb) => verb.run(),
        Verb::Payload(verb) => verb.run(),
    }))
}
