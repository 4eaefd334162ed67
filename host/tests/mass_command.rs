//! `softlimb payload estimate` as its user meets it.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A hanging limb with a payload.
const HANGING: &str = include_str!("../rig/tests/weight/hanging.toml");

/// [`HANGING`] without weight and with nothing to pick up.
fn empty() -> String {
    HANGING.replace("payload = \"50 g\", ", "") + "[weight]\nsimulated = false\n"
}

fn payload(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_softlimb")).arg("payload").args(words).current_dir(folder).output().unwrap()
}

/// What is said on standard output and on standard error.
fn said(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap())
}

const HEAD: &str = "phase,load,x_m,y_m,z_m";

/// Two phases whose tip goes down by these, m.
fn two(first_m: f64, second_m: f64) -> String {
    format!(
        "{HEAD}\nreach,none,0,0,0.7\nreach,unknown,0,0,{}\ncarry,none,0,0,0.7\ncarry,unknown,0,0,{}\n",
        0.7 - first_m,
        0.7 - second_m
    )
}

#[test]
fn wrong_tables_and_words_are_answered_with_line_column_value_and_what_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), empty()).unwrap();
    let row = |row: &str| format!("{HEAD}\nreach,none,0,0,0.7\n{row}\n");
    let kpa = |kpa: &str| format!("{HEAD},wrist_kpa\nreach,none,0,0,0.7,10\nreach,unknown,0,0,0.7,{kpa}\n");
    for (table, expected) in [
        (String::new(), "there is nothing: expected a header"),
        (format!("{HEAD}\n"), "there is a header alone"),
        ("phase,load,x_m,y_m\nreach,none,0,0\n".into(), "line 1: give a column `z_m`"),
        (
            format!("{HEAD},mass_kg\nreach,none,0,0,0,1\n"),
            "line 1: unknown column `mass_kg`; known are x_m, y_m, z_m, accuracy_mm, phase, load, wrist_kpa",
        ),
        (
            row("lift,unknown,0,0,0.6"),
            "line 3, column `phase`: `lift` is not allowed: one of reach, pick, carry, place",
        ),
        (row("reach,some,0,0,0.6"), "line 3, column `load`: `some` is not allowed: one of none, unknown"),
        (row("reach,unknown,0,0,low"), "line 3, column `z_m`: `low` is not allowed: a number from -100 to 100"),
        (row("reach,unknown,0,0,NaN"), "line 3, column `z_m`: `NaN` is not allowed: a number from -100 to 100"),
        (row("reach,unknown,0,,0.6"), "line 3, column `y_m`: `` is not allowed: a number"),
        (row("reach,unknown,0,0"), "line 3: 4 cells where the header has 5"),
        (
            row("reach,none,0,0,0.7"),
            "line 2, column `load`: `none` is not allowed: phase `reach` needs a row with `unknown` too",
        ),
        (
            row("pick,unknown,0,0,0.6"),
            "line 2, column `load`: `none` is not allowed: phase `reach` needs a row with `unknown` too",
        ),
        (
            format!("{HEAD}\npick,unknown,0,0,0.6\n"),
            "line 2, column `load`: `unknown` is not allowed: phase `pick` needs a row with `none` too",
        ),
        (row("reach,unknown,0,0,0.69"), "1 phase with and without the load: two are the fewest"),
        (kpa("5000"), "line 3, column `wrist_kpa`: `5000` is not allowed: a number from -5 to 2000"),
        (kpa("tight"), "line 3, column `wrist_kpa`: `tight` is not allowed"),
        (
            format!("{HEAD},accuracy_mm\nreach,none,0,0,0.7,0\n"),
            "line 2, column `accuracy_mm`: `0` is not allowed: a number from 0.001 to 100",
        ),
    ] {
        std::fs::write(folder.path().join("tips.csv"), &table).unwrap();
        let output = payload(folder.path(), &["estimate", "scene.toml", "--data", "tips.csv"]);
        let [out, err] = said(&output);
        assert!(err.starts_with("error: tips.csv: ") && err.contains(expected), "{table}\n{err}");
        assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{table}");
    }
    std::fs::write(folder.path().join("tips.csv"), two(1e-3, 1e-3)).unwrap();
    for (words, code, expected) in [
        (vec!["estimate", "scene.toml", "--data", "no.csv"], 1, "no.csv"),
        (vec!["estimate", "no.toml", "--data", "tips.csv"], 1, "no.toml"),
        (vec!["estimate", "--data", "tips.csv"], 2, "required"),
        (
            vec!["estimate", "scene.toml", "--data", "tips.csv", "--stiffness-error", "60"],
            2,
            "invalid value '60' for '--stiffness-error <PERCENT>': the range is 0 % to 50 %",
        ),
        (vec!["estimate", "scene.toml", "--data", "tips.csv", "--loads", "5"], 2, "--loads"),
        (
            vec!["track", "scene.toml", "--loads", "5,10", "--tips", "new.csv"],
            2,
            "--tips takes one load: --loads has 2",
        ),
        (
            vec!["track", "scene.toml", "--loads", "5", "--tips", "new.csv", "--camera", "-0.1 mm"],
            2,
            "invalid value '-0.1 mm' for '--camera <MM>': the range is 0 mm to 100 mm",
        ),
        (vec!["track", "scene.toml", "--tips", "new.csv"], 2, "--loads"),
    ] {
        let output = payload(folder.path(), &words);
        let [out, err] = said(&output);
        assert!(err.contains(expected), "{words:?}: {err}");
        assert_eq!((output.status.code(), out.as_str()), (Some(code), ""), "{words:?}: {err}");
        assert!(!folder.path().join("new.csv").exists(), "{words:?}");
    }
}

#[test]
fn load_that_is_not_told_from_none_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), empty()).unwrap();
    std::fs::write(folder.path().join("tips.csv"), two(1e-3, 1.1e-3)).unwrap();
    let output = payload(folder.path(), &["estimate", "scene.toml", "--data", "tips.csv"]);
    let [out, err] = said(&output);
    assert_eq!((output.status.code(), err.as_str()), (Some(0), ""), "{out}");
    for words in [
        "hanging: the mass on the tip, by 4 sightings in 2 phases",
        "5 degrees of freedom",
        "known to 10 %",
        "payload = \"0.",
    ] {
        assert!(out.contains(words), "{words}:\n{out}");
    }
    std::fs::write(folder.path().join("tips.csv"), two(1e-3, -1.1e-3)).unwrap();
    let output = payload(folder.path(), &["estimate", "scene.toml", "--data", "tips.csv"]);
    let [out, err] = said(&output);
    assert!(err.contains("warning: the interval reaches zero"), "{err}");
    assert!(output.status.code() == Some(3) && out.contains("payload = \"0.0000 kg\""), "{out}");
}

#[test]
fn tips_of_a_simulated_limb_tell_its_load() {
    let folder = tempfile::tempdir().unwrap();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/loaded/carry-hanging.toml");
    let track = ["--loads", "10", "--repeats", "1", "--iterations", "1", "--tips", "tips.csv", "--json"];
    let output = payload(folder.path(), &[&["track", scene], &track[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{:?}", said(&output));
    let table = std::fs::read_to_string(folder.path().join("tips.csv")).unwrap();
    assert!(table.starts_with("phase,load,x_m,y_m,z_m,shoulder_kpa,elbow_kpa,wrist_kpa\nreach,none,"), "{table}");
    assert_eq!(table.lines().count(), 9, "a header, four phases without and with the load");
    let output = payload(folder.path(), &["estimate", scene, "--data", "tips.csv", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{:?}", said(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let number = |name: &str| found[name].as_f64().unwrap();
    let kg = 10.0 / 9.806_65;
    assert!((number("mass_kg") / kg - 1.0).abs() < 0.15, "{found}");
    assert!((number("weight_n") - 9.806_65 * number("mass_kg")).abs() < 1e-9);
    let [low, high] = [0, 1].map(|end| found["interval_kg"][end].as_f64().unwrap());
    assert!(low < kg && kg < high, "{found}");
    let half = number("scatter_kg").hypot(number("stiffness_kg"));
    assert!((0.5 * (high - low) - half).abs() < 1e-9 && number("degrees_of_freedom") == 11.0);
    assert_eq!((found["phases"].as_array().unwrap().len(), found["rows"].as_array().unwrap().len()), (4, 8));
    assert_eq!((found["rows"][7]["line"].as_u64(), found["rows"][7]["load"].as_str()), (Some(9), Some("unknown")));
}
