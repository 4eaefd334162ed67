//! `run` and `report`: what they print where, what they leave behind, and which code they end with.

use serde_json::Value;

use crate::cli::desk::{Answer, Desk};

/// A supply that starts below what the controller demands, with a pump too weak to help.
const NO_AIR: &str = "name = \"small\"\nplant.supply.pressure = \"104 kPa\"\nplant.supply.stall_pressure = \"110 kPa\"\n\
                      plant.supply.flow = \"0.1 NL/min\"\nplant.supply.reservoir_volume = \"0.05 L\"\n\
                      limits.supply_min = \"100 kPa\"";

fn desk() -> Desk {
    Desk::with_scene("small", "small")
}

/// One JSON object on one line and nothing else.
#[track_caller]
fn one_object(answer: &Answer) -> Value {
    assert!(answer.out.ends_with('\n') && answer.out.lines().count() == 1, "{}", answer.out);
    let json = answer.json();
    assert!(json.is_object(), "{json}");
    json
}

#[test]
fn run_leaves_a_log_and_a_report_and_nothing_else() {
    let desk = desk();
    let answer = desk.softlimb("run scene.toml --out results").done();
    assert_eq!(desk.content(), ["results", "results/run.html", "results/run.mcap", "scene.toml"]);
    assert!(answer.out.starts_with("small  (simulated, seed 1, weightless)"), "{}", answer.out);
    assert!(answer.out.contains("real-time factor") && answer.out.contains("finger"), "{}", answer.out);
    assert!(answer.err.contains("results/run.mcap") && answer.err.contains("results/run.html"), "{}", answer.err);
}

#[test]
fn results_go_to_a_folder_of_the_scene_s_name() {
    let desk = desk();
    desk.softlimb("run scene.toml").done();
    assert!(desk.path("out/small/run.mcap").is_file() && desk.path("out/small/run.html").is_file());
}

#[test]
fn progress_bar_and_color_are_for_terminals_only() {
    let desk = desk();
    let answer = desk.softlimb("run scene.toml --out results").done();
    assert_eq!(answer.err.lines().count(), 2, "{}", answer.err);
    for text in [&answer.out, &answer.err] {
        assert!(!text.contains('\r') && !text.contains('\u{1b}'), "{text:?}");
    }
}

#[test]
fn json_is_one_object_for_programs() {
    let desk = desk();
    let json = one_object(&desk.softlimb("run scene.toml --out results --json").done());
    assert_eq!((&json["scene"], &json["seed"], &json["faults"]), (&"small".into(), &1.into(), &Value::Array(vec![])));
    let setpoint_rad = json["modules"][0]["setpoint_final"].as_f64().unwrap();
    // On the wire angles are whole microradians.
    assert!((setpoint_rad - 30_f64.to_radians()).abs() < 1e-6, "{setpoint_rad}");
    for path in ["/pressure/true_error_pa/rmse", "/tip/error_m/rmse", "/real_time_factor", "/modules/0/error/max"] {
        assert!(json.pointer(path).and_then(Value::as_f64).is_some_and(|value| value > 0.0), "{path}: {json}");
    }
}

const HURT: &str = "--link-fault loss=0.05,flip=0.1,duplicate=0.02";

#[test]
fn link_that_goes_wrong_is_repaired_and_counted() {
    let desk = desk();
    let run =
        |options: &str| one_object(&desk.softlimb(&format!("run scene.toml --out results --json {options}")).done());
    let (clean, hurt) = (run(""), run(HURT));
    let count =
        |json: &Value, key: &str| json["link"][key].as_u64().unwrap_or_else(|| panic!("{key}: {}", json["link"]));
    assert_eq!((count(&clean, "retransmitted"), count(&clean, "crc_errors")), (0, 0));
    assert!(count(&hurt, "retransmitted") > 3 && count(&hurt, "crc_errors") > 3, "{}", hurt["link"]);
    assert_eq!(hurt["faults"], Value::Array(vec![]));
    let rmse = |json: &Value| json.pointer("/pressure/true_error_pa/rmse").and_then(Value::as_f64).unwrap();
    // The valves' errors differ by a tenth from seed to seed, as they do from start to start.
    let of_seeds = |options: &str| {
        let squares = (1..=16).map(|seed| rmse(&run(&format!("--seed {seed} {options}"))).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let [clean, hurt] = ["", HURT].map(of_seeds);
    assert!((hurt / clean - 1.0).abs() < 0.05, "{hurt} {clean}");
}

#[test]
fn wrong_link_fault_is_named_with_what_there_is() {
    let answer = desk().softlimb("run scene.toml --link-fault lost=0.1");
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("\"lost\" is no link fault; there are loss, flip"), "{}", answer.err);
}

#[test]
fn seed_of_the_command_line_wins() {
    let desk = desk();
    let run = |line: &str| {
        let mut json = one_object(&desk.softlimb(line).done());
        let object = json.as_object_mut().unwrap();
        for of_the_clock in ["wall_s", "real_time_factor"] {
            assert!(object.remove(of_the_clock).is_some());
        }
        json
    };
    let of_scene = run("run scene.toml --out a --json");
    assert_eq!(run("run scene.toml --out b --json --seed 1"), of_scene);
    let other = run("run scene.toml --out c --json --seed 2");
    assert_eq!(other["seed"], 2);
    assert_ne!(other["modules"], of_scene["modules"]);
}

#[test]
fn second_run_replaces_the_first() {
    let desk = desk();
    desk.softlimb("run scene.toml --out results --seed 1").done();
    desk.softlimb("run scene.toml --out results --seed 2").done();
    let json = one_object(&desk.softlimb("report results/run.mcap --json").done());
    assert_eq!(json["seed"], 2);
    assert_eq!(desk.content(), ["results", "results/run.html", "results/run.mcap", "scene.toml"]);
}

#[test]
fn folder_that_cannot_be_made_fails_with_its_name() {
    let desk = desk();
    desk.put("file", "precious");
    for folder in ["file", "file/results"] {
        desk.softlimb(&format!("run scene.toml --out {folder}")).failed(1, &["cannot create the folder", folder]);
    }
    assert_eq!(std::fs::read_to_string(desk.path("file")).unwrap(), "precious");
    assert_eq!(desk.content(), ["file", "scene.toml"]);
}

/// `/proc` takes no folder, from no user.
#[cfg(target_os = "linux")]
#[test]
fn folder_in_a_place_that_takes_none_fails_with_its_name() {
    desk().softlimb("run scene.toml --out /proc/softlimb").failed(1, &["/proc/softlimb"]);
}

#[test]
fn log_that_cannot_take_its_name_is_kept_whole_beside_it() {
    let desk = desk();
    std::fs::create_dir_all(desk.path("results/run.mcap")).unwrap();
    desk.softlimb("run scene.toml --out results").failed(1, &["results/run.mcap"]);
    assert_eq!(desk.content(), ["results", "results/run.mcap", "results/run.mcap.partial", "scene.toml"]);
    desk.softlimb("report results/run.mcap.partial --out rescued.html").done();
}

#[test]
fn report_that_cannot_take_its_name_leaves_the_log_and_no_half_report() {
    let desk = desk();
    std::fs::create_dir_all(desk.path("results/run.html")).unwrap();
    desk.softlimb("run scene.toml --out results").failed(1, &["cannot write", "results/run.html"]);
    assert_eq!(desk.content(), ["results", "results/run.html", "results/run.mcap", "scene.toml"]);
    let before = desk.content();
    desk.softlimb("report results/run.mcap --out nowhere/run.html").failed(1, &["nowhere/run.html"]);
    assert_eq!(desk.content(), before);
}

#[test]
fn run_that_the_device_stops_fails_and_keeps_what_happened() {
    let desk = Desk::with_scene("name = \"small\"", NO_AIR);
    let run = desk.softlimb("run scene.toml --out results");
    assert_eq!((run.code, run.err.matches("error: ").count()), (Some(1), 1), "{run:?}");
    for word in ["supply", "kPa", "results/run.mcap", "results/run.html"] {
        assert!(run.err.contains(word), "`{word}` is missing: {}", run.err);
    }
    assert_eq!(desk.content(), ["results", "results/run.html", "results/run.mcap", "scene.toml"]);
    let report = desk.softlimb("report results/run.mcap --json");
    assert_eq!(report.code, Some(3), "{report:?}");
    assert!(report.err.contains("warning: ") && report.err.contains("s into the run: "), "{report:?}");
    let json = one_object(&report);
    assert!(!json["faults"].as_array().unwrap().is_empty(), "{json}");
}

#[test]
fn report_never_replaces_its_log() {
    let desk = desk();
    desk.softlimb("run scene.toml --out results").done();
    let log = std::fs::read(desk.path("results/run.mcap")).unwrap();
    desk.put("log.html", &log);
    let before = desk.content();
    for line in [
        "report results/run.mcap --out results/run.mcap",
        "report results/run.mcap --out results/../results/run.mcap",
        "report log.html",
    ] {
        desk.softlimb(line).failed(1, &["would replace the log", "--out"]);
        assert_eq!(desk.content(), before, "{line}");
    }
    desk.put("half.html.partial", &log);
    desk.softlimb("report half.html.partial --out half.html").done();
    for name in ["results/run.mcap", "log.html", "half.html.partial"] {
        assert!(std::fs::read(desk.path(name)).unwrap() == log, "{name} was changed");
    }
}

#[test]
fn log_that_was_cut_off_is_reported_with_a_warning() {
    let desk = desk();
    desk.softlimb("run scene.toml --out results").done();
    let log = std::fs::read(desk.path("results/run.mcap")).unwrap();
    desk.put("cut.mcap", &log[..log.len() * 4 / 5]);
    let answer = desk.softlimb("report cut.mcap");
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.out.contains("incomplete log") && answer.err.contains("warning: "), "{answer:?}");
    assert!(desk.path("cut.html").is_file());
}

#[test]
fn scene_selects_the_pressure_loop() {
    let error_pa = |pressure_loop: &str| {
        let desk = Desk::with_scene("seed = 1", &format!("seed = 1\ncontroller.loop = \"{pressure_loop}\""));
        let json = one_object(&desk.softlimb("run scene.toml --out results --json").done());
        desk.softlimb("replay results/run.mcap").done();
        json["pressure"]["true_error_pa"]["rmse"].as_f64().expect("a number")
    };
    let [pulses_pa, pi_pa, on_off_pa] = ["pulses", "pi", "on-off"].map(error_pa);
    assert!(pulses_pa < pi_pa && pulses_pa < on_off_pa && pi_pa != on_off_pa, "{pulses_pa} {pi_pa} {on_off_pa}");
}

#[test]
fn fault_on_purpose_is_met_reported_and_named() {
    let desk = desk();
    let run = desk.softlimb("run scene.toml --fault sensor-zero@0.5,0 --json");
    assert!(run.code == Some(1) && run.err.contains("the device stopped: "), "{run:?}");
    let summary: Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(summary["injected_faults"][0]["name"], "sensor-zero");
    assert_eq!(summary["faults"][0]["channel"], 0);
    let peak_pa = summary["peak_chamber_pa"][0].as_f64().expect("a number");
    let limit_pa = summary["pressure_limit_pa"][0].as_f64().expect("a number");
    assert!(peak_pa > 0.0 && peak_pa < limit_pa + 12e3, "{peak_pa} {limit_pa}");
    for (fault, told) in [
        ("sensor@1,0", "\"sensor\" is no fault; there are fill-stuck-open"),
        ("burst@1", "burst needs a channel"),
        ("burst@1,99", "channel 99 does not exist"),
        ("burst@9999,0", "the run ends at"),
    ] {
        let answer = desk.softlimb(&format!("run scene.toml --fault {fault}"));
        assert!(answer.code != Some(0) && answer.err.contains(told), "{fault}: {}", answer.err);
    }
}
