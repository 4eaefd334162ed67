//! `learn`, and corrections of a scene: from what was learned to a run.

use serde_json::Value;

use crate::cli::desk::{Desk, SCENE};

const KEY: &str = "\n[corrections]\nfile = \"learned.csv\"\n";

fn with_corrections(rows: &str) -> Desk {
    let desk = Desk::new();
    desk.put("scene.toml", SCENE.to_owned() + KEY);
    desk.put("learned.csv", rows);
    desk
}

/// Where the finger was asked to be at the end, and where it was, rad.
fn ends(desk: &Desk) -> [f64; 2] {
    let answer = desk.softlimb("run scene.toml --out results --json");
    let answer: Value = serde_json::from_str(&answer.out).unwrap();
    ["setpoint_final", "achieved_final"].map(|key| answer["modules"][0][key].as_f64().unwrap())
}

#[test]
fn corrections_are_added_to_what_is_sent_and_not_to_what_is_wanted() {
    let plain = Desk::with_scene("small", "small");
    let more = with_corrections("time_s,finger\n0,0\n1,0.2\n");
    let ([wanted, before], [same, after]) = (ends(&plain), ends(&more));
    assert_eq!(wanted, same);
    // The valves leave a degree or so.
    assert!((after - before - 0.2).abs() < 0.03, "{before} {after}");
}

#[test]
fn corrections_of_learning_are_read_by_a_scene() {
    let desk = Desk::new();
    desk.put("scene.toml", SCENE.replace("0.2 s", "1 s"));
    let found = desk.softlimb("learn scene.toml --iterations 2 --trials 1 --csv learned.csv --json").done().json();
    let at = |name: &str| found.pointer(name).and_then(Value::as_f64).unwrap();
    assert!(at("/learned/at_targets/rmse_m") > 0.0 && at("/by_model/at_targets/rmse_m") > 0.0);
    desk.put("scene.toml", SCENE.replace("0.2 s", "1 s") + KEY);
    desk.softlimb("check scene.toml").done();
    desk.softlimb("run scene.toml --out results").done();
    let again = desk.softlimb("learn scene.toml --iterations 2 --trials 1 --json").done().json();
    assert_eq!(again, found, "learning begins by the model alone");
}

#[test]
fn corrections_that_cannot_be_meant_are_refused_at_their_line() {
    let refused = |rows: &str, words: &[&str]| {
        for command in ["check scene.toml", "run scene.toml --out results"] {
            with_corrections(rows).softlimb(command).failed(1, words);
        }
    };
    refused(
        "time_s,elbow\n0,0\n1,0\n",
        &["learned.csv:1: the first row must be `time_s,finger`", "in this file", "scene.toml:"],
    );
    refused(
        "time_s,finger\n0,0\n",
        &["there are 1 rows below the header; a series has 2 to 10000", "in this file", "scene.toml:"],
    );
    refused(
        "time_s,finger\n0,0\n1,10\n",
        &["the correction of `finger` at 1 s is larger than its range", "572.96 deg here", "scene.toml:"],
    );
}
