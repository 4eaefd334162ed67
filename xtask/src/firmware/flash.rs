//! The image into the chip, by what is connected.

use std::process::{Command, Stdio};

use super::{Board, Files, Sizes, build};
use crate::trouble::Trouble;

/// Advice where no programmer is installed.
const INSTALL: &str = "\
nothing that writes a chip is installed. Either
  install probe-rs and connect the board by its debugger (NUCLEO: the USB plug): https://probe.rs, `cargo install probe-rs-tools`
or
  install dfu-util and connect the board's own USB plug, with BOOT0 held high while it starts:
  Debian, Ubuntu: apt-get install dfu-util      Fedora: dnf install dfu-util      macOS: brew install dfu-util";

/// Advice where `probe-rs` or `dfu-util` sees nothing.
const NO_DEBUGGER: &str = "probe-rs finds no debugger: connect the board by it (NUCLEO: the USB plug)";
const NO_LOADER: &str =
    "dfu-util finds no chip in its loader: connect the board's own USB plug, with BOOT0 held high while it starts";

/// Advice for both.
const CARE: &str = "\
Cut the supply of the valves first: while it is written, the chip's pins are not the program's.
On Linux the user needs access to the device: see https://probe.rs/docs/getting-started/probe-setup";

/// The chip's loader on the USB.
const LOADER: &str = "0483:df11";

/// Programmer of the connected chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Debugger,
    Loader,
}

/// Builds the image of a board and writes it into the chip that is connected.
///
/// # Errors
/// Nothing is connected, which is known before anything is built, or what writes fails.
pub(crate) fn flash(board: Board) -> Result<(), Trouble> {
    let list = [answer("probe-rs", &["list"]), answer("dfu-util", &["--list"])];
    let way = way(list.each_ref().map(Option::as_deref)).map_err(Trouble::Missing)?;
    let Files { elf, bin } = build(board, Sizes::Compare)?;
    let (elf, bin) = (elf.display().to_string(), bin.display().to_string());
    match way {
        Way::Debugger => {
            run("probe-rs", &["download", "--verify", "--connect-under-reset", "--chip", chip(board), &elf])?;
            run("probe-rs", &["reset", "--chip", chip(board)])
        }
        Way::Loader => {
            let place = "0x08000000:leave";
            run("dfu-util", &["--device", LOADER, "--alt", "0", "--dfuse-address", place, "--download", &bin])
        }
    }
}

/// The programmer, by the output of `probe-rs list` and `dfu-util --list`; none where they are not installed.
fn way([probes, loaders]: [Option<&str>; 2]) -> Result<Way, String> {
    if probes.is_some_and(has_probe) {
        return Ok(Way::Debugger);
    }
    if loaders.is_some_and(|text| text.contains(LOADER)) {
        return Ok(Way::Loader);
    }
    let seen = [probes.map(|_| NO_DEBUGGER), loaders.map(|_| NO_LOADER)];
    let seen: Vec<&str> = seen.into_iter().flatten().collect();
    let advice = if seen.is_empty() { INSTALL.to_owned() } else { seen.join("\nor\n") };
    Err(format!("{advice}\n{CARE}"))
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
    use super::*;

    const PROBE: &str = "The following debug probes were found:\n[0]: STLink V2-1 -- 0483:374b:066EFF (ST-LINK)\n";
    const NO_PROBE: &str = "No debug probes were found.\n";
    const DFU: &str = "Found DFU: [0483:df11] ver=2200, devnum=5, cfg=1, intf=0, path=\"1-1\", alt=0\n";

    #[test]
    fn a_debugger_comes_before_a_loader_and_either_before_advice() {
        assert_eq!(way([Some(PROBE), Some(DFU)]), Ok(Way::Debugger));
        assert_eq!(way([Some(PROBE), None]), Ok(Way::Debugger));
        assert_eq!(way([Some(NO_PROBE), Some(DFU)]), Ok(Way::Loader));
        assert_eq!(way([None, Some(DFU)]), Ok(Way::Loader));
    }

    #[test]
    fn advice_is_about_what_is_missing() {
        let advice = |lists| way(lists).unwrap_err();
        let (neither, probe_rs, dfu_util) =
            (advice([None, None]), advice([Some(NO_PROBE), None]), advice([None, Some("")]));
        assert!(neither.contains("cargo install probe-rs-tools") && neither.contains("apt-get install dfu-util"));
        assert!(probe_rs.contains(NO_DEBUGGER) && !probe_rs.contains(NO_LOADER) && !probe_rs.contains("install"));
        assert!(dfu_util.contains(NO_LOADER) && !dfu_util.contains(NO_DEBUGGER));
        assert!([neither, probe_rs, dfu_util].iter().all(|text| text.contains("Cut the supply")));
    }
}
