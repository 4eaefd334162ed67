//! The laboratory's command: records that keep what is left out, and both methods of a design.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A problem of eq. (14).
const EXTENSION: &str = include_str!("../../design/tests/problems/extension.json");
/// A problem of eq. (18).
const FORCES: &str = include_str!("../../design/tests/problems/forces.json");

fn lab(folder: &Path, line: &str) -> Output {
    let words = line.split_whitespace();
    Command::new(env!("CARGO_BIN_EXE_softlimb-lab")).args(words).current_dir(folder).output().expect("it runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[test]
fn record_keeps_what_is_not_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("all.tsv");
    let done = lab(folder.path(), "validation --only extension --tsv all.tsv");
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let first = std::fs::read_to_string(&file).expect("a record");
    lab(folder.path(), "validation --only twisting --tsv all.tsv");
    let both = std::fs::read_to_string(&file).expect("a record");
    assert!(both.starts_with(&first) && both.lines().count() == first.lines().count() + 24, "{both}");
    std::fs::write(&file, "not a record\n").expect("written");
    let wrong = lab(folder.path(), "validation --only extension --tsv all.tsv");
    assert_eq!(wrong.status.code(), Some(1));
    assert!(text(&wrong.stderr).contains("line 1 of the comparison"), "{}", text(&wrong.stderr));
    assert_eq!(std::fs::read_to_string(&file).expect("a record"), "not a record\n");
}

#[test]
fn page_without_a_place_and_an_unknown_case_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("page.md"), "# Nothing\n").expect("written");
    for (line, code, words) in [
        ("validation --page page.md", 1, "page.md has no place for the table"),
        ("validation --only hovering", 1, "no case has \"hovering\" in its name"),
        ("payload --kinds P7", 2, "--kinds: P7 is not allowed"),
    ] {
        let done = lab(folder.path(), line);
        let said = text(&done.stderr);
        assert!(done.status.code() == Some(code) && said.contains(words), "{said}");
    }
}

#[test]
fn swarm_finds_the_neighbourhood_that_projection_finds_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("reach.json"), EXTENSION).expect("written");
    let output = lab(folder.path(), "design --problem reach.json --evaluations 5000 --json");
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = found["rows"].as_array().expect("rows");
    let swarm = rows.iter().find(|row| row["end"]["evaluations"] == 5000).expect("the swarm");
    assert!(swarm["end"]["objective"].as_f64().is_some_and(|objective| objective < 1e-3), "{swarm}");
}

#[test]
fn problem_is_answered_by_both_methods() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("forces.json"), FORCES).expect("written");
    let output = lab(folder.path(), "payload --problem forces.json --json");
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let row = &found["comparison"][0];
    let objective = |method: &str| row[method]["objective"].as_f64().expect("a number");
    assert!(objective("gauss_newton") <= 1e-18 && objective("bfgs") >= objective("gauss_newton"), "{row}");
    assert!(row["bfgs"]["evaluations"].as_u64().is_some_and(|count| count > 1000), "{row}");
    let compared = text(&lab(folder.path(), "payload --kinds P1").stdout);
    assert!(compared.lines().any(|line| line.starts_with("P1 ")), "{compared}");
}
