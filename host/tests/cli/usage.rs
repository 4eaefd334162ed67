//! Help, version, and command lines that mean nothing.

use std::fs;
use std::path::Path;

use crate::cli::desk::Desk;

const VERBS: [&str; 17] = [
    "check",
    "run",
    "report",
    "device",
    "eval",
    "design",
    "payload",
    "calibrate",
    "learn",
    "materials",
    "fea",
    "workspace",
    "statics",
    "tolerance",
    "fabricate",
    "completions",
    "man",
];

#[test]
fn help_names_every_verb_the_exit_codes_and_where_to_start() {
    let help = Desk::new().softlimb("--help").done();
    for verb in VERBS {
        assert!(help.out.lines().any(|line| line.trim_start().starts_with(verb)), "{verb}: {}", help.out);
    }
    assert!(help.out.contains("Exit codes: 0 done, 1 failed, 2 wrong command line, 3 done with warnings."));
    assert!(help.out.contains("softlimb run scenes/"), "{}", help.out);
    assert_eq!(help.err, "");
}

#[test]
fn version_is_the_package_s() {
    let version = Desk::new().softlimb("--version").done();
    assert_eq!(version.out, format!("softlimb {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn verbs_show_an_example_of_themselves() {
    for verb in VERBS {
        let help = Desk::new().softlimb(&format!("{verb} --help")).done();
        let examples = help.out.split_once("Example").map(|(_, rest)| rest).unwrap_or_default();
        assert!(examples.contains(&format!("softlimb {verb} ")), "{verb}: {}", help.out);
    }
}

#[test]
fn retired_line_is_answered_with_its_present_form() {
    for (line, now) in [
        ("trials scene.toml", "softlimb learn SCENE"),
        ("fem run scene.toml", "softlimb fea"),
        ("bench accuracy", "cargo xtask lab accuracy"),
        ("design --problem reach.json", "softlimb design actuators FILE.json"),
        ("design scene.toml --json", "softlimb design limb SCENE"),
        ("payload scene.toml", "softlimb payload capacity SCENE"),
        ("payload --problem=forces.json", "softlimb design bundle FILE.json"),
        ("payload scene.toml --track 5,10", "softlimb payload track SCENE --loads 5,10"),
        ("payload scene.toml --estimate tips.csv", "softlimb payload estimate SCENE --data FILE.csv"),
        ("calibrate --tension silicone.csv", "softlimb calibrate tension FILE.csv"),
        ("fea run scene.toml --pressure-kpa 60", "--pressure 60kPa"),
        ("learn scene.toml --rehearsals 3", "--iterations"),
    ] {
        let answer = Desk::with_scene("small", "small").softlimb(line).failed(2, &["is now", now]);
        assert_eq!(answer.err.lines().count(), 1, "{}", answer.err);
    }
}

#[test]
fn completions_name_every_verb() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = Desk::new().softlimb(&format!("completions {shell}")).done().out;
        assert!(VERBS.iter().all(|verb| script.contains(verb)), "{shell}");
    }
}

/// Checks the page of a command and of each of its subcommands; the number of pages.
fn check_pages(command: &clap::Command, name: &str, folder: &Path) -> usize {
    let page = fs::read_to_string(folder.join(format!("{name}.1"))).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(page.contains(".TH") && page.contains(".SH SYNOPSIS"), "{name}: {page}");
    let options = command.get_arguments().filter(|argument| !argument.is_hide_set());
    for option in options.filter_map(clap::Arg::get_long) {
        assert!(page.replace("\\-", "-").contains(&format!("--{option}")), "{name}: no --{option}");
    }
    let verbs = command.get_subcommands().filter(|verb| verb.get_name() != "help" && !verb.is_hide_set());
    1 + verbs.map(|verb| check_pages(verb, &format!("{name}-{}", verb.get_name()), folder)).sum::<usize>()
}

#[test]
fn every_verb_has_a_manual_page() {
    let desk = Desk::new();
    desk.softlimb("man pages").done();
    let count = check_pages(&softlimb::cli::command(), "softlimb", &desk.path("pages"));
    assert!(count > VERBS.len());
    assert_eq!(fs::read_dir(desk.path("pages")).unwrap().count(), count, "pages of no verb");
    fs::write(desk.path("file"), "").unwrap();
    desk.softlimb("man file").failed(1, &["file"]);
}

#[test]
fn verb_that_is_none_is_a_wrong_command_line() {
    let answer = Desk::new().softlimb("runn scene.toml").failed(2, &["runn"]);
    assert!(answer.err.contains("run"), "no suggestion: {}", answer.err);
}

#[test]
fn missing_verb_shows_the_help_and_fails() {
    let answer = Desk::new().softlimb("");
    assert_eq!((answer.code, answer.out.as_str()), (Some(2), ""));
    assert!(answer.err.contains("Usage: softlimb <COMMAND>"), "{}", answer.err);
}

#[test]
fn missing_argument_is_named() {
    for verb in ["check", "run"] {
        Desk::new().softlimb(verb).failed(2, &["<SCENE>", "Usage:"]);
    }
    Desk::new().softlimb("report").failed(2, &["<LOG>", "Usage:"]);
    Desk::new().softlimb("eval").failed(2, &["SCENE", "--batch", "Usage:"]);
}

#[test]
fn options_that_do_not_fit_are_wrong_command_lines() {
    for (line, word) in [
        ("run scene.toml --sed 1", "--sed"),
        ("run scene.toml --seed many", "many"),
        ("run scene.toml --seed 1.5", "1.5"),
        ("run scene.toml --out", "--out"),
        ("run scene.toml other.toml", "other.toml"),
        ("run scene.toml --sample-period 2", "--port"),
        ("run scene.toml --port sim --sample-period 2", "every tick"),
        ("run scene.toml --port tcp:127.0.0.1:1 --sample-period 0", "1..=10000"),
        ("record --port tcp:127.0.0.1:1 -o log.mcap --sample-period 1.5", "1.5"),
        ("run scene.toml --port qemu --record-codes", "--record-codes is for a device behind --port"),
        ("run scene.toml --port tcp:127.0.0.1:1 --record-codes --sample-period 2", "cannot be used with"),
        ("eval scene.toml --batch questions.jsonl", "--batch"),
        ("eval scene.toml --steps 0", "0"),
        ("eval --batch questions.jsonl --scalar f16", "f16"),
        ("eval scene.toml --scalar f32", "--scalar"),
        ("eval --batch questions.jsonl --steps 5", "--steps"),
        ("eval --batch questions.jsonl --json", "--json"),
    ] {
        let desk = Desk::with_scene("small", "small");
        desk.softlimb(line).failed(2, &[word]);
        assert_eq!(desk.content(), ["scene.toml"], "{line}");
    }
}

#[test]
fn samples_that_a_line_does_not_carry_are_refused_before_the_port_is_opened() {
    let desk = Desk::with_scene("small", "small");
    let refused = |baud, words: &[&str]| {
        let line = format!("run scene.toml --port /dev/no-such-port --baud {baud} --sample-period 1");
        desk.softlimb(&line).failed(1, words);
    };
    refused(115_200, &["1 channel each 1 ms", "of a line of 115200 baud", "sample each 2 ms or less often"]);
    // Telemetry and answers alone take more than 85 % of it.
    refused(38_400, &["of a line of 38400 baud", "allowed: choose a higher baud"]);
    assert_eq!(desk.content(), ["scene.toml"]);
}
