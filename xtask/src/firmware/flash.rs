//! The image into the chip, by what is connected.

use std::process::{Command, Stdio};

use super::{Board, Files, Sizes, build};
use crate::image::Trouble;

/// What to do where nothing is connected.
const CURE: &str = "\
no debugger and no chip in its loader was found. Either
  connect the board by its debugger (NUCLEO: the USB plug) and install probe-rs: https://probe.rs, `cargo install probe-rs-tools`
or
  connect its USB plug with BOOT0 held high while it starts, and install dfu-util:
  Debian, Ubuntu: apt-get install dfu-util      Fedora: dnf install dfu-util      macOS: brew install dfu-util
Cut the supply of the valves first: while it is written, the chip's pins are not the program's.
On Linux the user needs access to the device: see https://probe.rs/docs/getting-started/probe-setup";

/// The chip's loader on the USB.
const LOADER: &str = "0483:df11";

/// Builds the image of a board and writes it into the chip that is connected.
///
/// # Errors
/// Nothing is connected, or what writes fails.
pub(crate) fn flash(board: Board) -> Result<(), Trouble> {
    let Files { elf, bin } = build(board, Sizes::Compare)?;
    let (elf, bin) = (elf.display().to_string(), bin.display().to_string());
    if answer("probe-rs", &["list"]).is_some_and(|text| has_probe(&text)) {
        run("probe-rs", &["download", "--verify", "--connect-under-reset", "--chip", chip(board), &elf])?;
        return run("probe-rs", &["reset", "--chip", chip(board)]);
    }
    if answer("dfu-util", &["--list"]).is_some_and(|text| text.contains(LOADER)) {
        let place = "0x08000000:leave";
        return run("dfu-util", &["--device", LOADER, "--alt", "0", "--dfuse-address", place, "--download", &bin]);
    }
    Err(Trouble::Missing(CURE.to_owned()))
}

fn chip(board: Board) -> &'static str {
    match board {
        Board::F446 => "STM32F446RETx",
        Board::F405 => "STM32F405RGTx",
    }
}

/// Whether `probe-rs list` lists one: its lines begin with a number in brackets.
fn has_probe(text: &str) -> bool {
    text.lines().any(|line| line.trim_start().starts_with("[0]"))
}

fn answer(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn run(program: &str, arguments: &[&str]) -> Result<(), Trouble> {
    println!("xtask: {program} {}", arguments.join(" "));
    let status = Command::new(program).args(arguments).status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(Trouble::Failed(format!("{program} did not succeed"))),
        Err(error) => Err(Trouble::Failed(format!("cannot run {program}: {error}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::has_probe;

    #[test]
    fn a_probe_is_told_from_none() {
        assert!(has_probe("The following debug probes were found:\n[0]: STLink V2-1 -- 0483:374b:066EFF (ST-LINK)\n"));
        assert!(!has_probe("No debug probes were found.\n"));
    }
}
