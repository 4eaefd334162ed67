//! The `softlimb` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    softlimb::cli::main()
}
