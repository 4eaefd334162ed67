//! The verb as its user meets it.

use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

fn softlimb(folder: &tempfile::TempDir, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb-lab"));
    command.args(line.split_whitespace()).current_dir(folder.path()).stdin(Stdio::null());
    command.output().expect("the binary was built with the tests")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[test]
fn table_is_printed_and_written() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("page.md"),
        "# Before\n<!-- written by cargo xtask lab accuracy -->\nold\n<!-- end -->\nAfter\n",
    )
    .unwrap();
    let output = softlimb(&folder, "accuracy --actuators 8 --seed 3 --tsv table.tsv --svg picture.svg --page page.md");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let table = softlimb_lab::accuracy::Report::from_tsv(&read("table.tsv")).unwrap();
    assert_eq!((table.seed, table.asked, table.answered), (3, 8, 8));
    assert!(table.rows.iter().all(|row| row.cost.time.is_some_and(|time| time > 0.0)));
    assert!(text(&output.stdout).lines().count() >= table.rows.len() + 2);
    let page = read("page.md");
    assert!(
        page.starts_with("# Before\n") && page.ends_with("<!-- end -->\nAfter\n") && !page.contains("\nold\n"),
        "{page}"
    );
    assert!(page.contains("### forward, bending") && page.contains("| B0 |"), "{page}");
    assert!(read("picture.svg").starts_with("<svg xmlns="));
}

/// A table as JSON with counts of instructions, where no instrument is found.
static BLIND: LazyLock<Output> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb-lab"));
    // A path without any program.
    command.args(["accuracy", "--actuators", "4", "--json", "--instructions"]).env("PATH", folder.path());
    command.stdin(Stdio::null()).output().expect("the binary was built with the tests")
});

#[test]
fn json_holds_the_same_lines() {
    let output = &*BLIND;
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = json["rows"].as_array().expect("rows");
    assert!(rows.iter().any(|row| row["method"] == "printed (13)" && row["max_error"].as_f64() > Some(0.1)), "{json}");
    assert!(json["reference"]["residual"].as_f64() < Some(1e-24));
}

#[test]
fn impossible_commands_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("empty.md"), "nothing\n").unwrap();
    for (line, code, words) in [
        ("accuracy --actuators 3", 2, "4..=100000"),
        ("accuracy --actuators many", 2, "many"),
        ("accuracy --page missing.md", 1, "cannot read missing.md"),
        ("accuracy --page empty.md", 1, "empty.md has no place for the tables"),
        ("accuracy --mcu missing.tsv", 1, "cannot read missing.tsv"),
        ("accuracy --actuators 4 --mcu empty.md", 1, "cannot use empty.md: no line of columns"),
        ("", 2, "Usage"),
    ] {
        let output = softlimb(&folder, line);
        assert_eq!(output.status.code(), Some(code), "{line}");
        assert!(text(&output.stderr).contains(words), "{line}: {}", text(&output.stderr));
    }
}

#[test]
fn missing_instrument_is_named() {
    let output = &*BLIND;
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("warning: valgrind is not installed"), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("forward"));
}
