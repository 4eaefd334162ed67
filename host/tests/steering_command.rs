//! Verbs that had one pressure a module, on a scene of steering modules.

use std::process::Command;

use serde_json::Value;

fn answer(words: &[&str]) -> (Option<i32>, Value) {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    let output = command.args(words).arg("--json").current_dir(scenes).output().expect("built with the tests");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let value = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{words:?}: {error}; {said}"));
    (output.status.code(), value)
}

fn length(value: &Value) -> usize {
    value.as_array().map_or(0, Vec::len)
}

const SCENE: &str = "scenes/steering.toml";

#[test]
fn payload_has_a_pressure_for_each_actuator() {
    let (code, said) = answer(&["payload", "capacity", SCENE]);
    assert_eq!(code, Some(0), "{said}");
    let poses = said["poses"].as_array().expect("poses");
    assert_eq!(poses.len(), 5, "at rest and four phases");
    for pose in poses {
        assert!(pose["modules"].as_array().expect("modules").iter().all(|module| length(&module["critical_n"]) == 3));
        if pose["outcome"] == "solved" {
            assert!(
                pose["modules"].as_array().expect("modules").iter().all(|module| length(&module["pressures_pa"]) == 3)
            );
        }
    }
    for pose in &poses[1..] {
        let carried = &pose["carried"];
        assert_eq!((length(&carried["pressures_pa"]), carried["keeps_margins"].as_bool()), (6, Some(true)), "{pose}");
        assert!(carried["payload_kg"].as_f64().expect("a mass") >= 0.3, "no less than the phase carries: {carried}");
    }
}

#[test]
fn workspace_has_a_pressure_for_each_actuator() {
    for pressures in ["modules", "actuators"] {
        let (code, said) = answer(&["workspace", SCENE, "--samples", "1000", "--pressures", pressures]);
        assert_eq!((code, length(&said["axes"])), (Some(0), 6), "{pressures}");
        let across = said["extents"][1]["range_m"].as_f64().expect("a range");
        assert!(across > 0.3, "it bends sideways, too: {across}");
    }
}

#[test]
fn tolerances_are_at_the_pressure_of_each_actuator() {
    let (code, said) = answer(&["tolerance", SCENE, "--samples", "20"]);
    assert_eq!(code, Some(0), "{said}");
    for phase in said["phases"].as_array().expect("phases") {
        assert_eq!(length(&phase["pressures_pa"]), 6, "{phase}");
        let [linear, sampled] = ["linear_rms_m", "rms_m"].map(|name| phase[name].as_f64().expect("a length"));
        let error = phase["rms_standard_error_m"].as_f64().expect("a length");
        assert!((linear - sampled).abs() < 4.0 * error + 0.1 * linear, "{phase}");
    }
}
