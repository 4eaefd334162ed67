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
    let more = with_corrections("phase,move,hold_s,finger\nbend,0,0,0\nbend,1,0,0.2\n");
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
        "phase,move,hold_s,elbow\nbend,1,0,0\n",
        &[
            "learned.csv:1: the first row must be `phase,move,hold_s,finger`; `finger.planned` may follow",
            "in this file",
            "scene.toml:",
        ],
    );
    for (rows, why) in [
        ("place,1,0,0", "learned.csv: there is no row for the phase `bend`"),
        ("bend,1.5,0,0", "learned.csv:2: `move`: 1.5 is not allowed: 0 to 1"),
        ("bend,0.5,1,0", "learned.csv:2: `hold_s`: 1 is not allowed: it is 0 while `move` is below 1"),
        ("bend,1,-1,0", "learned.csv:2: `hold_s`: -1 is not allowed: 0 to 3600"),
        ("bend,x,0,0", "learned.csv:2: `move`: `x` is not a finite number"),
        ("bend,1,0,0\nbend,1,0,0", "learned.csv:3: `move` and `hold_s` are not later than in the row before of `bend`"),
        ("bend,1,0", "learned.csv:2: 3 values, not 4"),
    ] {
        refused(&format!("phase,move,hold_s,finger\n{rows}\n"), &[why, "in this file", "scene.toml:"]);
    }
    refused(
        "phase,move,hold_s,finger\nbend,0,0,0\nbend,1,0,10\n",
        &["the correction of `finger` at 1 s of the run is larger than its range", "572.96 deg here", "scene.toml:"],
    );
}

/// Walls of another modulus, which do not creep: what is left at the end of a hold then holds on.
#[test]
fn corrections_of_learning_fit_longer_holds_and_slower_moves() {
    let desk = Desk::new();
    let scene = |duration: &str, hold: &str| {
        let scene = SCENE.replace("duration = \"1 s\"", &format!("duration = \"{duration}\"")).replace("0.2 s", hold);
        scene + "\n[plant.chamber]\ncreep_share = \"0 %\"\n"
    };
    desk.put("scene.toml", scene("1 s", "3 s"));
    desk.softlimb("learn scene.toml --iterations 4 --trials 1 --csv learned.csv").done();
    let off_rad = |text: String| {
        desk.put("scene.toml", text);
        let [wanted, achieved] = ends(&desk);
        (achieved - wanted).abs()
    };
    for (duration, hold) in [("1 s", "3 s"), ("1 s", "8 s"), ("2 s", "3 s"), ("1 s", "2 s")] {
        let [plain, corrected] = ["", KEY].map(|key| off_rad(scene(duration, hold) + key));
        println!("{duration} {hold}: {plain} {corrected}");
        assert!(corrected < 0.2 * plain, "{duration} {hold}: {plain} {corrected}");
    }
}

#[test]
fn corrections_of_another_goal_cause_a_warning() {
    let desk = Desk::new();
    desk.put("scene.toml", SCENE.replace("0.2 s", "1 s"));
    desk.softlimb("learn scene.toml --iterations 1 --trials 1 --csv learned.csv").done();
    let moved = SCENE.replace("0.2 s", "1 s").replace("30 deg", "45 deg") + KEY;
    desk.put("scene.toml", moved);
    let warning = "warning: the planned setpoints of `finger` in `bend` differ from those of the corrections by up to";
    for line in ["check scene.toml", "run scene.toml --out results"] {
        let answer = desk.softlimb(line);
        assert_eq!(answer.code, Some(3), "{answer:?}");
        assert!(answer.err.contains(warning) && answer.err.contains("% of its range"), "{answer:?}");
    }
}

#[test]
fn what_was_learned_is_tested_in_other_scenes_of_the_limb() {
    let desk = Desk::new();
    let scene = |hold: &str| SCENE.replace("0.2 s", hold) + "\n[plant.chamber]\ncreep_share = \"0 %\"\n";
    desk.put("scene.toml", scene("3 s"));
    desk.put("longer.toml", scene("6 s").replace("\"small\"", "\"longer\""));
    desk.put("other.toml", scene("3 s").replace("\"bend\"", "\"curl\""));
    desk.put("limb.toml", scene("3 s").replace("finger", "thumb"));
    let learn = "learn scene.toml --iterations 4 --trials 2 --test";
    let json = desk.softlimb(&format!("{learn} longer.toml --json")).done().json();
    let test = &json["tests"][0];
    assert_eq!(test["scene"], "longer");
    let [before, after] = ["by_model", "learned"].map(|key| test[key]["rmse_m"].as_f64().unwrap());
    assert!(0.0 < after && after < 0.25 * before, "{before} {after}");
    assert!(desk.softlimb(&format!("{learn} longer.toml")).done().out.contains("\ntested in longer "));
    desk.softlimb(&format!("{learn} other.toml")).failed(1, &["small has the phase `curl`, for which there are no"]);
    desk.softlimb(&format!("{learn} limb.toml"))
        .failed(1, &["small has other modules, actuators or quantities of setpoints than the scene of"]);
}
