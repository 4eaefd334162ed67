//! Files that are not what was asked for, in every verb that reads one.

use std::fs::File;
use std::io::Write;
use std::process::{Command, Stdio};

use softlimb_scene::SCENE_BYTES_MAX;

use crate::cli::desk::{Desk, SCENE};

/// Every way to hand a scene over.
const SCENE_VERBS: [&str; 3] = ["check", "run --out results", "eval"];

/// Asks every verb about the file `name`; each must fail with all of `words`, its path among them, and write nothing.
#[track_caller]
fn refused(desk: &Desk, name: &str, words: &[&str]) {
    let before = desk.content();
    for verb in SCENE_VERBS {
        desk.softlimb(&format!("{verb} {name}")).failed(1, words).failed(1, &[name]);
        assert_eq!(desk.content(), before, "{verb}");
    }
}

#[test]
fn missing_scene() {
    refused(&Desk::new(), "no-such.toml", &["there is no such file"]);
}

#[test]
fn folder_for_a_scene() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("folder")).unwrap();
    refused(&desk, "folder", &["it is a directory"]);
}

#[test]
fn empty_scene() {
    let desk = Desk::new();
    desk.put("scene.toml", "");
    refused(&desk, "scene.toml", &["the scene is empty"]);
    desk.put("scene.toml", "# nothing but a comment\n");
    refused(&desk, "scene.toml", &[]);
}

#[test]
fn scene_that_is_not_utf_8() {
    let desk = Desk::new();
    let mut bytes = SCENE.as_bytes().to_vec();
    // The `m` of "small", on the second line.
    let at = SCENE.find("small").unwrap() + 1;
    bytes[at] = 0xFF;
    desk.put("scene.toml", bytes);
    refused(&desk, "scene.toml", &["not UTF-8", &format!("byte {at}"), "line 2"]);
}

#[test]
fn hundred_megabytes_are_refused() {
    let desk = Desk::new();
    File::create(desk.path("huge")).unwrap().set_len(100 << 20).unwrap();
    for (line, word) in [
        ("check huge", "too large"),
        ("run huge --out results", "too large"),
        ("eval huge", "too large"),
        ("report huge", "not an MCAP file"),
    ] {
        desk.softlimb(line).failed(1, &["huge", word]);
    }
    assert_eq!(desk.content(), ["huge"]);
}

/// From a pipe, which has no size, every verb takes little more than a scene may have.
#[test]
#[cfg(unix)]
fn scene_without_end_is_left_after_its_greatest_size() {
    let desk = Desk::new();
    for verb in SCENE_VERBS {
        let mut child = Command::new(env!("CARGO_BIN_EXE_softlimb"))
            .args(verb.split_whitespace().chain(["/dev/stdin"]))
            .current_dir(desk.path("."))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary was built with the tests");
        let mut input = child.stdin.take().expect("is piped");
        let piece = [b' '; 4096];
        let taken = (0..25_000).take_while(|_| input.write_all(&piece).is_ok()).count() * piece.len();
        drop(input);
        assert_eq!(child.wait().unwrap().code(), Some(1), "{verb}");
        // What was in the pipe at the end, 64 KiB on Linux, was not read.
        assert!((taken as u64) < SCENE_BYTES_MAX + (1 << 20), "{verb}: {taken} bytes");
    }
}

#[test]
fn line_of_a_hundred_megabytes_is_one_invalid_question() {
    let desk = Desk::new();
    File::create(desk.path("huge")).unwrap().set_len(100 << 20).unwrap();
    let answer = desk.softlimb("eval --batch huge").done();
    assert_eq!(answer.out.lines().count(), 1);
    assert!(answer.out.len() < 1000, "{} bytes: the question is not repeated", answer.out.len());
    assert_eq!(answer.json()["status"], "invalid");
}

#[test]
fn logs_that_are_none() {
    let desk = Desk::new();
    desk.put("empty.mcap", "");
    desk.put("text.mcap", SCENE);
    // Begins and ends as the container asks, with nothing of ours inside.
    desk.put("other.mcap", b"\x89MCAP0\r\n\x89MCAP0\r\n");
    std::fs::create_dir(desk.path("folder.mcap")).unwrap();
    let before = desk.content();
    for (name, word) in [
        ("missing.mcap", "cannot read"),
        ("folder.mcap", "cannot read"),
        ("empty.mcap", "not an MCAP file"),
        ("text.mcap", "not an MCAP file"),
        ("other.mcap", "holds no softlimb run"),
    ] {
        desk.softlimb(&format!("report {name}")).failed(1, &[name, word]);
        assert_eq!(desk.content(), before, "{name}");
    }
}
