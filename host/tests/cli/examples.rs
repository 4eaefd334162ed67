//! The examples of every help text: all are lines of the grammar, and the cheap ones run.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Command;

use crate::cli::desk::{Desk, words};

/// Begins of examples that take too long, need files or devices of their own, or need CalculiX, and the one that `readme` runs.
const PARSED_ONLY: [&str; 36] = [
    "run scenes/pick-and-place-a.toml",
    "design limb",
    "design actuators",
    "design bundle",
    "payload track",
    "payload estimate",
    "calibrate",
    "learn",
    "materials --file",
    "jog",
    "console",
    "fea export finger.json",
    "fea run",
    "fea calibrate",
    "report",
    "sweep",
    "replay",
    "export",
    "recover",
    "record",
    "eval --batch",
    "workspace",
    "tolerance",
    "run calibrated.toml",
    "run scenes/single-bending.toml --port",
    "device test scenes/single-bending.toml --port /dev",
    "device serve",
    "device info",
    "device log",
    "device clear",
    "device sensors",
    "device monitor",
    "device valve",
    "device vent",
    "device zero",
    "device gripper",
];

/// Every example below a command, in the order of the help texts.
fn examples(command: &Command, found: &mut Vec<String>) {
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let lines = help.lines().map(|line| line.trim().trim_start_matches("Example: "));
    found.extend(lines.filter_map(|line| line.strip_prefix("softlimb ")).map(str::to_owned));
    command.get_subcommands().for_each(|verb| examples(verb, found));
}

/// Copies the scenes to the desk, where the examples find them.
fn copy(from: &Path, to: &PathBuf) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

#[test]
fn every_example_is_a_line_of_the_grammar() {
    let command = softlimb::cli::command();
    let mut found = Vec::new();
    examples(&command, &mut found);
    assert!(found.len() >= 25, "{found:?}");
    for line in found {
        let words = ["softlimb"].into_iter().chain(words(&line));
        let parsed = command.clone().try_get_matches_from(words);
        assert!(parsed.is_ok(), "{line}: {}", parsed.unwrap_err());
    }
}

#[test]
fn every_help_ends_with_an_example() {
    fn check(command: &Command, path: &str) {
        for verb in command.get_subcommands() {
            let path = format!("{path} {}", verb.get_name());
            let help = verb.get_after_help().map(ToString::to_string).unwrap_or_default();
            let last = help.lines().last().unwrap_or_default();
            assert!(last.contains(&path), "{path}: {help}");
            check(verb, &path);
        }
    }
    let command = softlimb::cli::command();
    for verb in command.get_subcommands() {
        let help = verb.get_after_help().map(ToString::to_string).unwrap_or_default();
        assert!(help.lines().last().unwrap_or_default().contains(&format!("softlimb {}", verb.get_name())), "{help}");
        check(verb, &format!("softlimb {}", verb.get_name()));
    }
}

#[test]
fn cheap_examples_run() {
    let desk = Desk::new();
    copy(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes")), &desk.path("scenes"));
    let mut found = Vec::new();
    examples(&softlimb::cli::command(), &mut found);
    found.retain(|line| !PARSED_ONLY.iter().any(|begin| line.starts_with(begin)));
    found.sort();
    found.dedup();
    assert!(found.len() >= 8, "{found:?}");
    for line in found {
        let answer = desk.softlimb(&line);
        assert!(matches!(answer.code, Some(0 | 3)), "{answer:?}");
    }
}
