//! `softlimb design actuators` as a command.

use std::process::{Command, Output};

use serde_json::Value;

/// A problem of eq. (14).
pub(crate) const EXTENSION: &str = include_str!("../design/tests/problems/extension.json");

fn softlimb(problem: &str, more: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("reach.json");
    std::fs::write(&file, problem).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.args(["design", "actuators"]).arg(&file).args(more).output().expect("the command runs")
}

#[test]
fn answer_is_json_with_everything_that_is_known_of_it() {
    let output = softlimb(EXTENSION, &["--json"]);
    assert!(output.status.success());
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(answer["status"], "reached");
    assert!(answer["objective"].as_f64().is_some_and(|objective| objective < 1e-12));
    let segment = &answer["segments"][0];
    for (field, low, high) in [("inner_radius_m", 0.006, 0.01), ("wall_m", 0.003, 0.005), ("length_m", 0.1, 0.3)] {
        let value = segment[field].as_f64().expect("a number");
        assert!((low - 1e-15..=high + 1e-15).contains(&value), "{field} {value}");
    }
    let phase = &segment["phases"][1];
    assert!((phase["found"].as_f64().expect("a number") - 0.21).abs() < 1e-12);
    assert!(phase["pressure_pa"].as_f64().is_some_and(|pressure| pressure > 0.0));
    assert!(segment["condition"].is_number() && segment["active_bounds"].is_array());
    for field in ["model_solves", "derivatives", "evaluations"] {
        assert!(answer["cost"][field].is_u64(), "{field}");
    }
}

#[test]
fn table_is_for_people_and_mistakes_name_file_and_line() {
    let output = softlimb(EXTENSION, &[]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.starts_with("reached: objective ") && text.contains("arm: inner radius"), "{text}");
    let output = softlimb(&EXTENSION.replace("60000", "-1"), &["--json"]);
    let text = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    let rest = text.split_once("reach.json: ").map(|(_, rest)| rest.trim_end());
    assert_eq!(rest, Some("line 15: segments[0].bounds.pressure_max_pa = -1 is not allowed: > 0"));
}

#[test]
fn starts_on_one_line_that_do_not_agree_are_a_warning() {
    let line = EXTENSION
        .replace("\"format\": 1,", "\"format\": 1, \"shared_pressure\": true,")
        .replace("[0.2, 0.21]", "[0.11, 0.4]");
    let output = softlimb(&line, &["--starts", "1"]);
    let text = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("warning: 1 of 1 local solves agree on the least objective"), "{text}");
    assert_eq!(softlimb(&line, &[]).status.code(), Some(0));
}
