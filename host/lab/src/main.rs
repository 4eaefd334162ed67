//! The laboratory's command.

use std::process::ExitCode;

fn main() -> ExitCode {
    softlimb_lab::main()
}
