//! Runs an image in the emulator of a board.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

const EMULATOR: &str = "qemu-system-arm";

/// What to do where there is none.
const CURE: &str = "\
the emulator qemu-system-arm is not installed:
  Debian, Ubuntu: apt-get install qemu-system-arm      Fedora: dnf install qemu-system-arm
  macOS:          brew install qemu                    Windows: https://www.qemu.org/download/#windows";

/// An instruction takes 2^8 ns of the emulated time and the board's timer counts every 40 ns: 6.4 counts an instruction, so that the
/// instructions follow from the counts without doubt.
const SHIFT: &str = "shift=8,sleep=off";
/// Counts and instructions of the same stretch.
const COUNTS: i64 = 32;
const INSTRUCTIONS: i64 = 5;

/// A run takes less than a second; an image that hangs is ended.
const PAUSE: Duration = Duration::from_millis(50);
const PAUSES_MAX: u32 = 1200;

/// Finds the emulator.
///
/// # Errors
/// What to install.
pub(crate) fn find() -> Result<(), String> {
    let found = Command::new(EMULATOR).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    found.is_ok_and(|status| status.success()).then_some(()).ok_or_else(|| CURE.to_owned())
}

/// Instructions for a difference of counts of the timer.
pub(crate) fn instructions(counts: i64) -> i64 {
    (2 * counts * INSTRUCTIONS + COUNTS).div_euclid(2 * COUNTS)
}

/// Counts for a number of instructions, where it is a whole number of them.
pub(crate) fn counts(instructions: i64) -> i64 {
    instructions * COUNTS / INSTRUCTIONS
}

/// What the image prints.
///
/// # Errors
/// The emulator does not start, the image hangs or leaves with a failure.
pub(crate) fn run(image: &Path) -> Result<String, String> {
    let mut child = Command::new(EMULATOR)
        .args(["-machine", "mps2-an386", "-display", "none", "-monitor", "none", "-serial", "null"])
        .args(["-semihosting-config", "enable=on,target=native", "-icount", SHIFT, "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("cannot run {EMULATOR}: {error}"))?;
    let output = child.stdout.take();
    let reader = thread::spawn(move || {
        let mut text = String::new();
        output.map(|mut output| output.read_to_string(&mut text)).transpose().map(|_| text)
    });
    let mut pauses = 0;
    let status = loop {
        match child.try_wait().map_err(|error| error.to_string())? {
            Some(status) => break status,
            None if pauses == PAUSES_MAX => {
                // Either may fail when it has just ended by itself.
                let _ = child.kill();
                let _ = child.wait();
                return Err("the image hangs in the emulator".to_owned());
            }
            None => thread::sleep(PAUSE),
        }
        pauses += 1;
    };
    let text = reader.join().map_err(|_| "the reader of the emulator's output failed".to_owned())?;
    let text = text.map_err(|error| error.to_string())?;
    if status.success() { Ok(text) } else { Err(format!("the image failed in the emulator; it printed\n{text}")) }
}

#[cfg(test)]
mod tests {
    use super::{counts, instructions};

    #[test]
    fn instructions_are_told_from_counts_that_are_one_off() {
        for n in 0..2000 {
            for off in -1..=1 {
                assert_eq!(instructions(n * 64 / 10 + off + i64::from(n * 64 % 10 >= 5)), n);
            }
        }
        assert_eq!(instructions(counts(100_000)), 100_000);
    }
}
