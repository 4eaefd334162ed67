//! What the commands say where tools are missing, or find nothing to write into: on a PATH that holds what the test puts there.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder that holds these scripts and nothing else.
fn programs(name: &str, scripts: &[(&str, &str)]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Left by a run before, or not there.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for (program, text) in scripts {
        let path = folder.join(program);
        let draft = folder.join("draft");
        fs::write(&draft, format!("#!/bin/sh\n{text}\n")).unwrap();
        fs::set_permissions(&draft, fs::Permissions::from_mode(0o755)).unwrap();
        // A file cannot be started while anybody has it open for writing: a child that another thread forks would have what this process has.
        assert!(Command::new("cp").args([&draft, &path]).status().unwrap().success());
        fs::remove_file(&draft).unwrap();
    }
    folder
}

/// Exit code and standard error of `xtask` where PATH is that folder alone.
fn xtask(arguments: &[&str], path: &Path) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(arguments).env("PATH", path).env_remove("CARGO").env_remove("RUSTC");
    let output = command.output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn without_a_compiler_for_the_microcontroller_both_ways_to_one_are_named() {
    let nothing = programs("no-compiler", &[]);
    for arguments in [&["firmware"][..], &["firmware", "--board", "f405"], &["model-image"]] {
        let (code, text) = xtask(arguments, &nothing);
        assert_eq!(code, Some(2), "{text}");
        for cure in ["rustup target add thumbv7em-none-eabihf", "apt-get install rustc-web cargo-web rust-web-src lld"]
        {
            assert!(text.contains(cure), "{text}");
        }
    }
}

#[test]
fn without_an_emulator_it_is_named_too() {
    let (code, text) = xtask(&["model-image"], &programs("no-emulator", &[]));
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("apt-get install qemu-system-arm") && text.contains("rustc-web"), "{text}");
}

/// What `xtask test` prints, and what it asks `apt-get` for, as a user of this number.
fn set_up(name: &str, options: &[&str], user: u32) -> (String, String) {
    let asked = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.asked"));
    let _ = fs::remove_file(&asked);
    let apt = format!("echo \"$@\" >> '{}'", asked.display());
    let path = programs(name, &[("apt-get", &apt), ("id", &format!("echo {user}"))]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.arg("test").args(options).env("PATH", path).env_remove("CARGO").env_remove("RUSTC").env_remove("CI");
    let printed = command.output().unwrap().stdout;
    (String::from_utf8(printed).unwrap(), fs::read_to_string(asked).unwrap_or_default())
}

#[test]
fn root_is_told_what_will_be_installed_before_it_is() {
    let (printed, asked) = set_up("apt-of-root", &[], 0);
    // The first call only looks whether there is one.
    let asked: Vec<&str> = asked.lines().skip(1).collect();
    let install = |packages| format!("-qq --yes --no-install-recommends install {packages}");
    let packages = [
        "rustc-web cargo-web rust-web-src lld",
        "qemu-system-arm",
        "calculix-ccx",
        "valgrind binutils",
        "python3 python3-venv",
        "tmux",
        "chromium python3-pip",
        "python3-pip",
    ];
    assert_eq!(asked, [vec!["-qq update".to_owned()], packages.map(install).to_vec()].concat());
    let calls = printed.find("xtask: apt-get -qq update").expect("it says what it calls");
    for package in packages {
        assert!(printed.find(package).is_some_and(|at| at < calls), "{package} is named before:\n{printed}");
    }
}

#[test]
fn others_are_told_what_to_install_and_what_was_skipped() {
    for (name, options, user) in [("apt-of-others", &[][..], 1000), ("no-install", &["--no-install"], 0)] {
        let (printed, asked) = set_up(name, options, user);
        assert!(asked.lines().count() <= 1, "{name} asks for {asked}");
        for package in ["rustc-web cargo-web rust-web-src lld", "qemu-system-arm", "calculix-ccx", "valgrind binutils"]
        {
            assert!(printed.contains(&format!("apt-get install {package}")), "{name}:\n{printed}");
        }
        let end: Vec<&str> = printed.lines().rev().take_while(|line| !line.starts_with("xtask: ")).collect();
        assert!(end.contains(&"skipped: images for the board"), "{name}:\n{printed}");
    }
}

#[test]
fn a_compiler_that_is_too_old_or_has_no_library_is_none() {
    for (name, version) in [("old-compiler", "1.63.0"), ("no-library", "1.99.0")] {
        let answers = format!(
            "case $1 in --version) echo 'rustc {version} (x)';; --print=sysroot) echo /nowhere;; *) echo x86_64-unknown-linux-gnu;; esac"
        );
        let (code, text) = xtask(&["firmware"], &programs(name, &[("rustc", &answers), ("cargo", "exit 1")]));
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains("no installed toolchain builds for"), "{text}");
    }
}

#[test]
fn flash_says_what_to_install_where_nothing_writes() {
    let (code, text) = xtask(&["flash", "--board", "f446"], &programs("no-writer", &[]));
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("cargo install probe-rs-tools") && text.contains("apt-get install dfu-util"), "{text}");
}

#[test]
fn flash_says_what_to_connect_where_nothing_is_connected() {
    let scripts = [("probe-rs", "echo 'No debug probes were found.'"), ("dfu-util", "echo 'dfu-util 0.11'")];
    let (code, text) = xtask(&["flash"], &programs("no-probe", &scripts));
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("probe-rs finds no debugger") && text.contains("dfu-util finds no chip"), "{text}");
    assert!(!text.contains("apt-get"), "it is installed: {text}");
}

#[test]
fn a_debugger_that_is_found_leads_on_to_the_build() {
    let scripts = [("probe-rs", "echo '[0]: STLink V2-1 -- 0483:374b:066EFF (ST-LINK)'")];
    let (code, text) = xtask(&["flash"], &programs("a-probe", &scripts));
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("no installed toolchain builds for"), "the next thing that is missing: {text}");
}
