//! Standard output that takes nothing: a reader that went away, and a disk that is full.

use std::process::{Command, Stdio};

use crate::cli::desk::Desk;

const VERBS: [&str; 4] =
    ["check scene.toml", "check scene.toml --json", "eval scene.toml --steps 1000", "eval scene.toml --json"];

/// Exit code and standard error of `softlimb` with the words of a line, printing to `out`.
fn printing_to(desk: &Desk, line: &str, out: impl Into<Stdio>) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_softlimb"))
        .args(line.split_whitespace())
        .current_dir(desk.path(""))
        .stdin(Stdio::null())
        .stdout(out)
        .output()
        .expect("the binary was built with the tests");
    (output.status.code(), String::from_utf8(output.stderr).expect("standard error is UTF-8"))
}

#[test]
fn reader_that_went_away_is_no_failure() {
    let desk = Desk::with_scene("small", "small");
    for line in VERBS {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        assert_eq!(printing_to(&desk, line, writer), (Some(0), String::new()), "{line}");
    }
}

/// `/dev/full` is a disk without room.
#[cfg(target_os = "linux")]
#[test]
fn full_disk_fails_with_a_message() {
    let desk = Desk::with_scene("small", "small");
    for line in VERBS {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
        let (code, message) = printing_to(&desk, line, full);
        assert_eq!(code, Some(1), "{line}: {message}");
        assert!(message.starts_with("error: cannot write to standard output: "), "{line}: {message}");
    }
    desk.softlimb("run scene.toml --out results").done();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
    let (code, message) = printing_to(&desk, "report results/run.mcap", full);
    assert_eq!(code, Some(1), "{message}");
    assert!(message.starts_with("error: cannot write to standard output: "), "{message}");
}
