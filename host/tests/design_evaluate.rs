//! `softlimb design actuators --evaluate`.

use std::io::Write;
use std::process::{Command, Output, Stdio};

use fra_model::{Actuator, Load};
use serde_json::Value;
use softlimb_design::actuators::{Geometry, Problem};

use crate::design_command::EXTENSION;

fn softlimb(problem: &str, more: &[&str], input: &str) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("reach.json");
    std::fs::write(&file, problem).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.current_dir(folder.path()).args(["design", "actuators"]).arg(&file).args(more);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it runs");
    child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("it reads");
    child.wait_with_output().expect("it ends")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[test]
fn points_of_the_box_are_answered_with_the_objective_of_their_geometry_and_pressures() {
    let text_of = EXTENSION.replace("\"targets\"", "\"target_weights\": [1, 4], \"targets\"");
    let output = softlimb(&text_of, &["--evaluate"], "[0, 1, 0.5, 0.2, 0, 1]\n[0.5, 0.5, 0.5, 0.5, 0.25, 0.5]\n");
    let answers: Vec<Value> =
        text(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(answers.len(), 2);
    // These tubes have no limit point below the highest pressure of 60 kPa: shares are shares of that.
    let problem = Problem::read(&text_of).expect("a problem");
    let points = [([0.006, 0.011, 0.2, 3.0], [0.0, 60e3]), ([0.008, 0.012, 0.2, 7.5], [15e3, 30e3])];
    for (answer, ([inner_radius_m, outer_radius_m, length_m, angle], pressures)) in answers.iter().zip(points) {
        let geometry = Geometry { inner_radius_m, outer_radius_m, length_m, angle_rad: f64::to_radians(angle) };
        let actuator = Actuator::new(&problem.segments()[0].parameters(&geometry)).expect("a geometry of the model");
        let length = |p| actuator.forward(p, &Load::none()).expect("finite").state.axial_stretch * length_m;
        let differences = [1e3 * (length(pressures[0]) - 0.2), 2e3 * (length(pressures[1]) - 0.21)];
        for (found, expected) in answer["differences"].as_array().expect("an array").iter().zip(differences) {
            assert!((found.as_f64().expect("a number") - expected).abs() < 1e-9, "{found} {expected}");
        }
        let sum: f64 = differences.iter().map(|one| one * one).sum();
        assert!((answer["objective"].as_f64().expect("a number") / sum - 1.0).abs() < 1e-9);
    }
}

#[test]
fn points_outside_the_box_are_refused_by_line() {
    for (line, message) in [
        (
            "[0, 0, 0, 0, 0]",
            "line 2: [5 numbers] is not allowed: 6, those of the geometries and a share for each pressure",
        ),
        ("[0, 0, 0, 1.5, 0, 0]", "line 2: [3] = 1.5 is not allowed: 0 to 1"),
        ("0.5", "line 2: no array of numbers"),
    ] {
        let output = softlimb(EXTENSION, &["--evaluate"], &format!("[0, 0, 0, 0, 0, 0]\n{line}\n"));
        let complaint = text(&output.stderr);
        assert!(complaint.contains(message) && output.status.code() == Some(1), "{complaint}");
    }
}
