//! `device serve` as a program of its own, and `run --port` on it in real time.

mod log;

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use softlimb::rig::record;

use crate::cli::desk::{Desk, SCENE};
use crate::cli::program::Program;

/// Runs in which a busy computer may pause a program for so long that the terminal loses bytes.
const ATTEMPTS: usize = 3;

/// The small scene, with samples at every millisecond: pulses of valves and samples beat against each other otherwise.
fn desk(more: &str) -> Desk {
    Desk::with_scene("seed = 1\n", &format!("seed = 1\ncontroller.telemetry_period = \"1 ms\"\n{more}"))
}

fn rmse_pa(json: &Value) -> f64 {
    json["pressure"]["measured_error_pa"]["rmse"].as_f64().unwrap()
}

/// Every key of a JSON value.
fn keys(json: &Value, found: &mut Vec<String>) {
    match json {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| {
            found.push(key.clone());
            keys(value, found);
        }),
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[track_caller]
fn contains(file: &Path, words: &[&str]) -> bool {
    let bytes = std::fs::read(file).unwrap();
    words.iter().any(|word| bytes.windows(word.len()).any(|window| window == word.as_bytes()))
}

#[test]
fn run_behind_a_terminal_tracks_as_in_the_process_and_shows_measurements_alone() {
    let desk = desk("");
    let here = desk.softlimb("run scene.toml --out here --json").done().json();
    let reference = rmse_pa(&here);
    let is_near = |found: f64| (found - reference).abs() < 0.05 * reference;
    let run = || {
        let mut device = Program::start(&desk, "device serve scene.toml");
        let address = device.first_line();
        let ended = desk.softlimb(&format!("run scene.toml --out there --port {address} --json"));
        assert_eq!(device.interrupt(), Some(0));
        ended
    };
    let mut ended = run();
    for _ in 1..ATTEMPTS {
        if ended.code != Some(0) || !is_near(rmse_pa(&ended.json())) {
            println!("run again: {ended:?}");
            ended = run();
        }
    }
    let there = ended.done().json();
    let found = rmse_pa(&there);
    println!("RMSE of the measured pressure: {found:.1} Pa behind a terminal, {reference:.1} Pa in the process");
    assert!(is_near(found), "{found} Pa, in the process {reference} Pa");
    let factor = there["real_time_factor"].as_f64().unwrap();
    assert!((0.5..=1.05).contains(&factor), "real time: {factor}");

    let mut names = Vec::new();
    keys(&there, &mut names);
    for truth in ["achieved_final", "error", "error_m", "final_error_m", "true_error_pa", "seed"] {
        assert!(!names.iter().any(|name| name == truth), "{truth}: {there}");
    }
    let log = record::read(desk.path("there/run.mcap")).unwrap();
    assert_eq!((log.incomplete, log.info.simulated), (None, false));
    assert!(log.info.start_unix_ns > 1_700_000_000_000_000_000, "{}", log.info.start_unix_ns);
    assert!(log.samples.iter().all(|sample| sample.tip_achieved_m.is_none()));
    let truth = ["/softlimb/truth", "/softlimb/modules/achieved"];
    assert!(contains(&desk.path("here/run.mcap"), &truth) && !contains(&desk.path("there/run.mcap"), &truth));
    let table = desk.softlimb("report there/run.mcap").done().out;
    assert!(table.starts_with("small  (on a device)"), "{table}");
    assert!(!table.contains("achieved") && !table.contains("chamber"), "{table}");
    let seen = ["achieved", "chamber"];
    assert!(contains(&desk.path("here/run.html"), &seen) && !contains(&desk.path("there/run.html"), &seen));
}

/// Whether there is a Python. Continuous integration must have it, or nobody would notice.
fn python_is_installed() -> bool {
    let found = Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_ok();
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(found || !ci, "CI is set and Python is missing: apt-get install python3");
    if !found {
        let _ =
            writeln!(std::io::stderr(), "skipped: client in Python; it is missing (Debian: apt-get install python3)");
    }
    found
}

/// `protocol/examples/client.py` shares no code with the workspace: whoever reads SPEC.md can write it.
#[test]
fn client_written_from_the_specification_runs_a_limb() {
    if !python_is_installed() {
        return;
    }
    let desk = desk("");
    let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
    let client = concat!(env!("CARGO_MANIFEST_DIR"), "/../protocol/examples/client.py");
    let answer = Command::new("python3").args([client, &device.first_line(), "--seconds", "2"]).output().unwrap();
    let (told, error) = (String::from_utf8_lossy(&answer.stdout), String::from_utf8_lossy(&answer.stderr));
    assert!(answer.status.success(), "{told}{error}");
    assert!(told.contains("ran 101 knots") && told.contains("; vented"), "{told}");
    // The gripper closes half way through a run of 2 s with a message every 5 ms.
    let words: Vec<&str> = told.split_whitespace().collect();
    let after = |word: &str| words.iter().skip_while(|found| **found != word).nth(1).and_then(|word| word.parse().ok());
    let (closed, all): (Option<f64>, Option<f64>) = (after("in"), after("of"));
    let share = closed.unwrap() / all.unwrap();
    assert!((share - 0.5).abs() < 0.1 && all.unwrap() > 200.0, "{told}");
    device.until("Ready");
    device.until("Running");
    device.until("Ready");
}

#[test]
fn device_is_operated_by_hand() {
    // Between two commands the link is lost: the device holds for so long.
    let desk = desk("controller.hold_time = \"60 s\"\n");
    let mut device = Program::start(&desk, "device serve scene.toml");
    let address = device.first_line();
    let hand = |line: &str| desk.softlimb(&format!("device {line} --port {address}"));
    let refused = hand("zero");
    assert_eq!(refused.code, Some(1));
    assert!(
        refused.err.contains("refuses Command: it is idle; it becomes ready once it is configured"),
        "{}",
        refused.err
    );
    let filled = hand("valve 0 fill 40 --scene scene.toml --json").done().json();
    let kpa = |json: &Value, key: &str| 1e-3 * json[key].as_f64().unwrap();
    assert!(kpa(&filled, "before_pa") < 0.5 && kpa(&filled, "after_pa") > 1.0, "{filled}");
    assert_eq!((&filled["effect"], &filled["channel"]), (&Value::Bool(true), &0.into()));
    let vented = hand("valve 0 vent 0.5s").done().out;
    assert!(vented.starts_with("channel 0: vent for 500 ms, ") && vented.ends_with("passed\n"), "{vented}");
    let again = hand("valve 0 vent 50").done().out;
    assert!(again.ends_with("nothing to let out: fill first\n"), "{again}");
    let absent = hand("valve 7 fill 40");
    assert!(absent.code == Some(1) && absent.err.contains("channel is out of range"), "{}", absent.err);
    let short = hand("valve 0 fill 0.5");
    assert!(short.code == Some(2) && short.err.contains("1 ms to 1000 ms"), "{}", short.err);
    hand("gripper close").done();
    hand("vent").done();
    assert_eq!(hand("zero").done().out, "the zeros are taken; the device is ready\n");
}

#[test]
fn device_is_tested_step_by_step() {
    let desk = desk("");
    let verdicts = |json: &Value| {
        let steps = json["steps"].as_array().unwrap().iter();
        steps.map(|step| format!("{} {}", step["step"].as_str().unwrap(), step["verdict"].as_str().unwrap())).collect()
    };
    let here = desk.softlimb("device test scene.toml --port sim --json").done().json();
    let found: Vec<String> = verdicts(&here);
    let steps = ["link", "configuration", "sensor", "supply", "valves closed", "fill valve", "leak", "vent valve"];
    let passed: Vec<String> = steps.iter().chain(&["pressures down"]).map(|step| format!("{step} passed")).collect();
    assert_eq!((found, &here["passed"]), (passed, &Value::Bool(true)));

    // Vented channels creep back while the next one is filled.
    let nine = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/pick-and-place-a.toml");
    desk.softlimb(&format!("device test {nine} --port sim")).done();

    let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
    let port = device.first_line();
    let table = desk.softlimb(&format!("device test scene.toml --port {port}")).done().out;
    assert!(
        table.lines().count() == 10 && !table.contains("failed") && table.contains("leak             0  passed"),
        "{table}"
    );

    // A supply below the least that the scene allows.
    desk.put("hungry.toml", SCENE.replace("[weight]", "[limits]\nsupply_min = \"270 kPa\"\n\n[plant]\nsupply = { kind = \"regulated\", pressure = \"290 kPa\" }\n\n[weight]"));
    let hungry = desk.softlimb(&format!("device test hungry.toml --port {port}"));
    assert_eq!(hungry.code, Some(3));
    assert!(hungry.err.contains("warning: supply: ") && hungry.err.contains("allowed 270.0 to"), "{}", hungry.err);
    assert!(hungry.out.contains("look at: pump") && hungry.out.contains("left out"), "{}", hungry.out);
    desk.softlimb("device test scene.toml --port qemu").failed(2, &["device serve", "--mcu qemu"]);
}

#[test]
fn device_without_a_scene_is_one_bending_actuator() {
    let desk = Desk::new();
    let mut device = Program::start(&desk, "device serve --tcp 127.0.0.1:0");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/single-bending.toml");
    let answer = desk.softlimb(&format!("device sensors --scene {scene} --port {} --json", device.first_line())).done();
    assert_eq!(answer.json().as_array().unwrap().len(), 2, "the supply and one channel: {}", answer.out);
}

#[test]
fn second_program_looks_beside_a_run() {
    let desk = desk("");
    let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
    let port = device.first_line();
    let mut host = Program::start(&desk, &format!("run scene.toml --out results --port {port}"));
    device.until("Running");
    let info = desk.softlimb(&format!("device info --port {port} --json")).done().json();
    assert_eq!(info["commanded_by_another"], Value::Bool(true));
    assert!(info.get("port_errors").is_none(), "{info}");
    desk.softlimb(&format!("device vent --port {port}")).failed(1, &["another program controls the device"]);
    desk.softlimb(&format!("device log --port {port}")).failed(1, &["another program controls the device"]);
    desk.softlimb(&format!("device monitor --port {port} --lines 1")).done();
    assert_eq!(host.ended(), Some(0));
}

#[test]
fn device_that_vanishes_is_told_and_the_log_is_whole() {
    let desk = desk("");
    for (place, begin) in [("--pty", "/dev/"), ("--tcp 127.0.0.1:0", "tcp:127.0.0.1:")] {
        vanishes(&desk, place, begin);
    }
}

/// A device at a place whose address begins so.
fn vanishes(desk: &Desk, place: &str, begin: &str) {
    let mut device = Program::start(desk, &format!("device serve scene.toml {place}"));
    let address = device.first_line();
    assert!(address.starts_with(begin), "{address}");
    let mut host = Program::start(desk, &format!("run scene.toml --out results --port {address}"));
    device.until("Running");
    std::thread::sleep(Duration::from_millis(500));
    device.kill();
    host.until(&format!("the port failed: {address} is gone: unplugged"));
    assert_eq!(host.ended(), Some(1));
    let log = record::read(desk.path("results/run.mcap")).unwrap();
    assert_eq!(log.incomplete, None);
    let last_s = log.samples.last().unwrap().time_s;
    assert!((0.3..1.1).contains(&last_s), "the last sample is of {last_s} s");
    desk.softlimb("report results/run.mcap").done();
}

#[test]
fn device_whose_host_is_killed_holds_ramps_and_vents() {
    let desk = desk("controller.hold_time = \"0.5 s\"\ncontroller.vent_ramp = \"40 kPa/s\"\n");
    let mut device = Program::start(&desk, "device serve scene.toml");
    let address = device.first_line();
    let mut host = Program::start(&desk, &format!("run scene.toml --out results --port {address}"));
    let running_s = device.until("Running");
    std::thread::sleep(Duration::from_millis(300));
    host.kill();
    device.until("fault: link lost");
    let holding_s = device.until("Holding");
    let venting_s = device.until("Venting");
    let ready_s = device.until("Ready");
    // The device has all knots: 1.2 s of motion, and the last one again a second later.
    assert!((holding_s - running_s - 2.2).abs() < 0.1, "holding after {} s", holding_s - running_s);
    assert!((venting_s - holding_s - 0.5).abs() < 0.1, "venting after {} s", venting_s - holding_s);
    // At least the ramp's time: the finger is at about 30 kPa.
    assert!((0.5..4.0).contains(&(ready_s - venting_s)), "empty after {} s", ready_s - venting_s);
    let faults = |line: &str| desk.softlimb(&format!("device monitor --port {address} --lines 1 {line}")).done().out;
    assert!(faults("").contains("link lost"), "{}", faults(""));
    desk.softlimb(&format!("device clear --port {address}")).done();
    assert!(faults("--json").contains("\"faults\":[]"), "{}", faults("--json"));
    // The log keeps what was cleared.
    let log = desk.softlimb(&format!("device log --port {address}")).done().out;
    let lines: Vec<_> = log.lines().collect();
    assert!(lines.len() == 4 && lines[1].contains("1                start: PowerOn"), "{log}");
    assert!(lines[2].contains("link lost for ") && lines[3] == "records are stored", "{log}");
    // The next host finds a device that it can run on.
    desk.softlimb(&format!("run scene.toml --out results --port {address}")).done();
}

#[test]
fn ctrl_c_vents_the_limb_and_ends_the_run() {
    let desk = desk("");
    let mut device = Program::start(&desk, "device serve scene.toml");
    let address = device.first_line();
    let host = Program::start(&desk, &format!("run scene.toml --out results --port {address}"));
    let running_s = device.until("Running");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(host.interrupt(), Some(3));
    let venting_s = device.until("Venting");
    assert!(venting_s - running_s < 1.2, "before the end of the motion: {} s", venting_s - running_s);
    assert_eq!(record::read(desk.path("results/run.mcap")).unwrap().incomplete, None);
}

#[test]
fn lines_that_contradict_themselves_are_refused() {
    let desk = desk("");
    for (line, words) in [
        ("run scene.toml --port ttyACM0", ["ttyACM0", "tcp:HOST:PORT"]),
        ("run scene.toml --port tcp:host:0", ["tcp:host:0", "1 to 65535"]),
        ("run scene.toml --port sim --baud 9600", ["sim", "baud"]),
        ("run scene.toml --port /dev/ttyACM0 --baud 300", ["300", "1200 to 10000000"]),
        ("run scene.toml --port /dev/ttyACM0 --seed 3", ["--seed", "--port /dev/ttyACM0"]),
        ("run scene.toml --port sim --mcu qemu", ["--mcu", "--port sim"]),
    ] {
        desk.softlimb(line).failed(2, &words);
    }
    desk.softlimb("run scene.toml --port /dev/no-such-port").failed(1, &["/dev/no-such-port", "device list"]);
    desk.softlimb("device serve scene.toml --tcp nowhere").failed(1, &["cannot serve at nowhere"]);
}

#[test]
fn sim_is_the_run_without_an_address() {
    let desk = desk("");
    let out = |line: &str| {
        let text = desk.softlimb(line).done().out;
        text.lines().skip(2).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(out("run scene.toml --port sim"), out("run scene.toml"));
}

#[test]
fn board_is_asked_measured_and_watched() {
    let desk = desk("");
    let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
    let port = format!("--port {}", device.first_line());
    let info = desk.softlimb(&format!("device info {port} --json")).done().json();
    assert_eq!((&info["state"], &info["boot_cause"]), (&"Idle".into(), &"PowerOn".into()), "{info}");
    assert!(info["channels_max"].as_u64() == Some(27) && info.get("config_hash").is_none(), "{info}");
    let none = serde_json::json!({ "overrun": 0, "framing": 0, "noise": 0, "parity": 0, "queue_full": 0 });
    assert_eq!(info["port_errors"], none, "{info}");
    let log = desk.softlimb(&format!("device log {port} --json")).done().json();
    assert_eq!((&log["condition"], &log["unstored"]), (&"Kept".into(), &0.into()), "{log}");
    let start = serde_json::json!([{ "number": 1, "cause": "PowerOn", "detail": 0, "faults": [] }]);
    assert_eq!(log["starts"], start, "{log}");
    // A device without a configuration measures nothing.
    desk.softlimb(&format!("device sensors {port}")).failed(1, &["no measurements", "--scene"]);
    let readings = desk.softlimb(&format!("device sensors {port} --scene scene.toml --time 0.3s --json")).done().json();
    let names: Vec<_> =
        readings.as_array().unwrap().iter().map(|reading| reading["sensor"].as_str().unwrap()).collect();
    assert_eq!(names, ["supply", "channel 0"]);
    let mean_pa = |index: usize| readings[index]["mean_pa"].as_f64().unwrap();
    assert!(mean_pa(0) > 150e3, "the supply is on: {readings}");
    assert!(mean_pa(1) < 1e3, "the chamber is empty: {readings}");
    let table = desk.softlimb(&format!("device info {port}")).done().out;
    assert!(table.contains("state          Ready") && !table.contains("none"), "{table}");
    assert!(table.contains("port errors    no error"), "{table}");
    let watched = desk.softlimb(&format!("device monitor {port} --period 0.05s --lines 3 --json")).done().out;
    let lines: Vec<Value> = watched.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let times: Vec<f64> = lines.iter().map(|line| line["time_s"].as_f64().unwrap()).collect();
    assert!(lines.len() == 3 && times.windows(2).all(|pair| pair[1] - pair[0] >= 0.049), "{watched}");
    let text = desk.softlimb(&format!("device monitor {port} --lines 2")).done().out;
    assert!(text.lines().count() == 2 && text.contains("Ready  supply") && !text.contains('\u{1b}'), "{text}");
    assert_eq!(device.interrupt(), Some(0));
}

#[test]
fn device_verbs_want_a_port() {
    let desk = Desk::new();
    desk.softlimb("device list").done();
    assert!(desk.softlimb("device list --json").done().json().is_array());
    desk.softlimb("device info --port sim").failed(2, &["sim", "device serve"]);
    desk.softlimb("device log --port sim").failed(2, &["sim", "device serve"]);
    desk.softlimb("device info").failed(2, &["--port"]);
}
