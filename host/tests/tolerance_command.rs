//! `softlimb tolerance` as its user meets it.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::tolerance_text::text_of;

fn run(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.arg("tolerance").args(words).current_dir(folder).output().expect("the binary was built with the tests")
}

fn texts(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned())
}

/// A folder with a scene of two modules in one phase.
fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let text = text_of(&[("extension", "slant", 3, ""), ("bending", "", 2, "")]).replace(
        "{ m0 = { pressure = \"1 kPa\" } }",
        "{ m0 = { axial_stretch = 1.1 }, m1 = { bend_angle = \"40 deg\" } }",
    );
    std::fs::write(folder.path().join("scene.toml"), text).expect("written");
    folder
}

#[test]
fn answer_is_a_table_files_and_the_same_json_on_any_number_of_threads() {
    let desk = desk();
    let output = run(desk.path(), &["scene.toml", "--samples", "40", "--svg", "a.svg", "--csv", "a.csv"]);
    let [out, err] = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    for word in [
        "walls +- 0.1 mm",
        "angles +- 1 deg",
        "moduli +- 10 %",
        "40 limbs, seed 1",
        "only",
        "m0",
        "m1",
        "wall",
        "linear",
    ] {
        assert!(out.contains(word), "{word}: {out}");
    }
    let csv = std::fs::read_to_string(desk.path().join("a.csv")).expect("a table");
    assert_eq!(csv.lines().count(), 41);
    let squares = csv.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!((cells.len(), cells[1], cells[8]), (9, "only", ""));
        cells[2..5].iter().map(|cell| cell.parse::<f64>().expect("a number").powi(2)).sum::<f64>()
    });
    let rms = (squares.sum::<f64>() / 40.0).sqrt();
    assert!(std::fs::read_to_string(desk.path().join("a.svg")).expect("a picture").starts_with("<svg "));
    let jsons = ["1", "2", "5"].map(|threads| {
        texts(&run(desk.path(), &["scene.toml", "--samples", "40", "--json", "--threads", threads]))[0].clone()
    });
    assert!(jsons[0] == jsons[1] && jsons[0] == jsons[2]);
    let answer: Value = serde_json::from_str(&jsons[0]).expect("JSON");
    let phase = &answer["phases"][0];
    assert!((phase["rms_m"].as_f64().expect("a number") - rms).abs() < 1e-8, "{phase} {rms}");
    assert_eq!((&phase["samples"], &phase["lost"]), (&40.into(), &serde_json::json!({})));
    assert_eq!(phase["shares"].as_object().expect("shares").len(), 5);
}

#[test]
fn limbs_that_cannot_hold_the_pressure_are_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = text_of(&[("expansion", "lines", 1, "")]);
    std::fs::write(folder.path().join("scene.toml"), &text).expect("written");
    // The highest pressure that the model still follows is named by the workspace.
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    let space =
        command.args(["workspace", "scene.toml", "--samples", "10", "--json"]).current_dir(folder.path()).output();
    let space: Value = serde_json::from_slice(&space.expect("run").stdout).expect("JSON");
    let kpa = 1e-3 * space["axes"][0]["pressure_max_pa"].as_f64().expect("a number");
    std::fs::write(folder.path().join("scene.toml"), text.replace("1 kPa", &format!("{:.3} kPa", kpa * 0.999)))
        .expect("written");
    let output = run(folder.path(), &["scene.toml", "--samples", "60", "--csv", "a.csv"]);
    let [_, err] = texts(&output);
    assert_eq!(output.status.code(), Some(3), "{err}");
    let csv = std::fs::read_to_string(folder.path().join("a.csv")).expect("a table");
    let lost = csv.lines().filter(|line| line.ends_with(",m0") && line.contains(",only,,,,")).count();
    assert!(lost > 0 && err.contains(&format!("{lost} of 60 limbs")) && err.contains("`m0`"), "{lost} {err}");
}

#[test]
fn impossible_queries_are_named() {
    let desk = desk();
    for (words, code, names) in [
        (vec!["scene.toml", "--wall", "-0.1"], 2, vec!["--wall", "'-0.1'", "the range is 0 mm to 5 mm"]),
        (vec!["scene.toml", "--wall", "-1mm"], 2, vec!["--wall", "'-1mm'", "the range is 0 mm to 5 mm"]),
        (vec!["scene.toml", "--wall=-100 um"], 2, vec!["--wall", "'-100 um'", "the range is 0 um to 5000 um"]),
        (
            vec!["scene.toml", "--wall", "0.1kPa"],
            2,
            vec!["--wall", "this is a pressure: give a length, in mm for example"],
        ),
        (vec!["scene.toml", "--wall", "4.5"], 2, vec!["--wall 4.5 is not allowed", "less than the wall of `m0`, 4 mm"]),
        (vec!["scene.toml", "--wall", "0.45 cm"], 2, vec!["--wall 0.45 cm is not", "the wall of `m0`, 0.4 cm"]),
        (vec!["scene.toml", "--angle", "12"], 2, vec!["--angle", "'12'", "0 deg to 10 deg"]),
        (vec!["scene.toml", "--modulus", "51"], 2, vec!["--modulus", "'51'", "0 % to 50 %"]),
        (vec!["scene.toml", "--modulus", "much"], 2, vec!["--modulus", "much"]),
        (vec!["scene.toml", "--samples", "-5"], 2, vec!["--samples", "-5 is not in 10..=100000"]),
        (vec!["scene.toml", "--samples", "5"], 2, vec!["--samples", "10..=100000"]),
        (vec!["scene.toml", "--threads", "0"], 2, vec!["--threads", "1..=1024"]),
        (vec![], 2, vec!["<SCENE>"]),
        (vec!["other.toml"], 1, vec!["other.toml"]),
    ] {
        let output = run(desk.path(), &words);
        let [out, err] = texts(&output);
        assert_eq!((output.status.code(), out.as_str()), (Some(code), ""), "{words:?}: {err}");
        assert!(names.iter().all(|name| err.contains(name)), "{words:?}: {err}");
    }
}
