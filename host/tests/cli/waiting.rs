//! Verbs that compute for long: Ctrl-C, and the time on a terminal.

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use softlimb::rig::record;

use super::desk::Desk;

/// Longest wait for a sample.
const PATIENCE: Duration = Duration::from_secs(60);

fn start(desk: &Desk, line: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.args(line.split_whitespace()).current_dir(desk.path(""));
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// As Ctrl-C does; the exit code and the messages.
fn interrupt(child: Child) -> (Option<i32>, String) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let ended = child.wait_with_output().unwrap();
    (ended.status.code(), String::from_utf8(ended.stderr).unwrap())
}

#[test]
fn interrupt_says_that_results_are_lost() {
    let desk = Desk::with_scene(r#"hold = "0.2 s""#, r#"hold = "60 s""#);
    let child = start(&desk, "learn scene.toml --iterations 200 --csv learned.csv");
    sleep(Duration::from_secs(3));
    let (code, messages) = interrupt(child);
    assert_eq!(
        (code, messages.as_str()),
        (Some(130), "interrupted: files that were written are whole; unfinished results are lost\n")
    );
    assert!(!desk.path("learned.csv").exists());
}

#[test]
fn interrupted_run_vents_and_keeps_its_log() {
    let desk = Desk::with_scene(r#"hold = "0.2 s""#, r#"hold = "600 s""#);
    let child = start(&desk, "run scene.toml");
    let began = Instant::now();
    // The file is there before its first sample.
    let has_samples = || record::read(desk.path("out/small/run.mcap.partial")).is_ok_and(|log| !log.samples.is_empty());
    while !has_samples() {
        assert!(began.elapsed() < PATIENCE, "no log");
        sleep(Duration::from_millis(20));
    }
    let (code, messages) = interrupt(child);
    assert_eq!(code, Some(3), "{messages}");
    assert!(messages.contains("warning: the run was canceled"), "{messages}");
    let log = record::read(desk.path("out/small/run.mcap")).unwrap();
    let end_s = log.samples.last().unwrap().time_s;
    assert!(end_s < 600.0, "{end_s} s");
    assert!(desk.path("out/small/run.html").exists());
}

/// `script` gives a terminal.
#[cfg(target_os = "linux")]
#[test]
fn time_shows_on_a_terminal_after_two_seconds() {
    let desk = Desk::with_scene(r#"hold = "0.2 s""#, r#"hold = "60 s""#);
    let softlimb = env!("CARGO_BIN_EXE_softlimb");
    let line = format!("timeout -s INT 6 {softlimb} learn scene.toml --iterations 200 --trials 100");
    let ended = Command::new("script").args(["-qec", &line, "/dev/null"]).current_dir(desk.path("")).output().unwrap();
    let shown = String::from_utf8_lossy(&ended.stdout);
    // A busy computer draws late.
    let first = shown.split_once("computing for ").map_or("", |(_, rest)| rest);
    assert!((2..=5).any(|s| first.starts_with(&format!("00:00:0{s}; Ctrl-C ends it"))), "{shown}");
    assert!(shown.contains("interrupted: "), "{shown}");
}
