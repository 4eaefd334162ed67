//! Runs an image in the emulator of a board.

use std::io::Read;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

const EMULATOR: &str = "qemu-system-arm";

/// Advice where there is none.
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

/// Interval between checks of the emulator, and their number in half an hour. A traced run takes minutes, and longer on a busy computer.
const PAUSE: Duration = Duration::from_millis(50);
const PAUSES_MAX: u32 = 36_000;

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

/// Output of the image.
///
/// # Errors
/// The emulator does not start, the image hangs or leaves with a failure.
pub(crate) fn run(image: &Path) -> Result<String, String> {
    let told = |mut errors: ChildStderr| std::io::copy(&mut errors, &mut std::io::stderr()).map_err(|e| e.to_string());
    listened(command(image), told).map(|(text, _)| text)
}

/// Output of the image, and the result of `listen` on the emulator's account of every instruction: a hundred times slower.
///
/// # Errors
/// As [`run`]; those of `listen`.
pub(crate) fn traced<T: Send>(
    image: &Path,
    listen: impl FnOnce(ChildStderr) -> Result<T, String> + Send,
) -> Result<(String, T), String> {
    let mut command = command(image);
    command.args(["-d", "exec,nochain"]).args(one_by_one()?);
    listened(command, listen)
}

fn command(image: &Path) -> Command {
    let mut command = Command::new(EMULATOR);
    command
        .args(["-machine", "mps2-an386", "-display", "none", "-monitor", "none", "-serial", "null"])
        .args(["-semihosting-config", "enable=on,target=native", "-icount", SHIFT, "-kernel"])
        .arg(image);
    command
}

fn listened<T: Send>(
    mut command: Command,
    listen: impl FnOnce(ChildStderr) -> Result<T, String> + Send,
) -> Result<(String, T), String> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("cannot run {EMULATOR}: {error}"))?;
    let (Some(mut output), Some(told)) = (child.stdout.take(), child.stderr.take()) else {
        return Err(format!("{EMULATOR} has no output"));
    };
    let (status, text, heard) = thread::scope(|scope| {
        let reader = scope.spawn(move || {
            let mut text = String::new();
            output.read_to_string(&mut text).map(|_| text).map_err(|error| error.to_string())
        });
        let listener = scope.spawn(move || listen(told));
        let status = wait(&mut child);
        let ended = |_| "a reader of the emulator's output failed".to_owned();
        (status, reader.join().map_err(ended).flatten(), listener.join().map_err(ended).flatten())
    });
    let (status, text) = (status?, text?);
    if status.success() {
        Ok((text, heard?))
    } else {
        Err(format!("the image failed in the emulator; it printed\n{text}"))
    }
}

/// Waits for the emulator, or ends it.
fn wait(child: &mut Child) -> Result<ExitStatus, String> {
    for _ in 0..PAUSES_MAX {
        match child.try_wait().map_err(|error| error.to_string())? {
            Some(status) => return Ok(status),
            None => thread::sleep(PAUSE),
        }
    }
    // Either may fail when it has just ended by itself.
    let _ = child.kill();
    let _ = child.wait();
    Err("the image hangs in the emulator".to_owned())
}

/// The option by which the emulator takes one instruction at a time, which has got another name.
fn one_by_one() -> Result<&'static [&'static str], String> {
    let help = Command::new(EMULATOR).arg("--help").stderr(Stdio::null()).output();
    let help = help.map_err(|error| format!("cannot run {EMULATOR}: {error}"))?;
    let has_old = String::from_utf8_lossy(&help.stdout).lines().any(|line| line.starts_with("-singlestep"));
    Ok(if has_old { &["-singlestep"] } else { &["-accel", "tcg,one-insn-per-tb=on"] })
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
