//! `softlimb design --compare` and `--evaluate`.

use std::io::Write;
use std::process::{Command, Output, Stdio};

use fra_model::{Actuator, Load};
use serde_json::Value;
use softlimb::design::fit::{Geometry, Problem};

use crate::common::{EXTENSION, extension};

fn softlimb(problem: &str, more: &[&str], input: &str) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("reach.json");
    std::fs::write(&file, problem).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.current_dir(folder.path()).arg("design").arg("--problem").arg(&file).args(more);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it runs");
    child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("it reads");
    let mut output = child.wait_with_output().expect("it ends");
    for kept in ["c.tsv", "c.svg"] {
        output.stderr.extend(std::fs::read(folder.path().join(kept)).unwrap_or_default());
    }
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[test]
fn both_methods_are_compared_on_the_same_problem() {
    let files = ["--compare", "--evaluations", "3000", "--seeds", "2", "--tsv", "c.tsv", "--svg", "c.svg"];
    let output = softlimb(EXTENSION, &files, "");
    let table = text(&output.stdout);
    assert!(output.status.success() && table.contains("| reach | projection | 2 of 2 |"), "{table}");
    let kept = text(&output.stderr);
    // Every objective of the file is at most the one before it, and costs do not fall.
    let (mut points, mut before) = (0, (String::new(), [0.0; 3], f64::INFINITY));
    let lines =
        kept.lines().filter(|line| line.starts_with("reach\t")).map(|line| line.split('\t').collect::<Vec<_>>());
    for cells in lines {
        let run = cells[1..3].join(" ");
        let cost = [3, 4, 5].map(|column: usize| cells[column].parse::<f64>().expect("a number"));
        let objective: f64 = cells[6].parse().expect("a number");
        if run == before.0 {
            assert!((0..3).all(|i| cost[i] >= before.1[i]), "{cells:?}");
            // The end of the projection is its answer by the forward model: rounding where the search has left nothing.
            assert!(objective <= before.2 + 1e-20, "{cells:?}");
        }
        points += 1;
        before = (run, cost, objective);
    }
    assert!(points > 20 && kept.contains("<svg"), "{kept}");
}

#[test]
fn ends_and_solves_of_a_comparison_are_those_of_the_answer() {
    let table: Value =
        serde_json::from_slice(&softlimb(EXTENSION, &["--compare", "--evaluations", "50", "--json"], "").stdout)
            .expect("JSON");
    let answer: Value = serde_json::from_slice(&softlimb(EXTENSION, &["--json"], "").stdout).expect("JSON");
    let [ours, swarm] = [0, 1].map(|row| &table["rows"][row]);
    assert_eq!((&ours["method"], &swarm["method"]), (&Value::from("projection"), &Value::from("pso")));
    assert_eq!(ours["end"]["model_solves"], answer["cost"]["model_solves"]);
    assert_eq!(ours["end"]["objective"], answer["objective"]);
    assert_eq!((&swarm["end"]["evaluations"], &swarm["end"]["model_solves"]), (&Value::from(50), &Value::from(100)));
    assert_eq!((&ours["solved"], &swarm["solved"]), (&Value::from(1), &Value::from(0)));
}

#[test]
fn points_of_the_box_are_answered_with_the_objective_of_their_geometry_and_pressures() {
    let text_of = extension(&[("\"targets\"", "\"target_weights\": [1, 4], \"targets\"")]);
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
fn what_is_no_point_of_the_box_is_refused_by_line() {
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
    let output = softlimb(EXTENSION, &["--svg", "x.svg"], "");
    assert!(text(&output.stderr).contains("--compare") && output.status.code() == Some(1));
    let output = softlimb(EXTENSION, &["--compare", "--kinds", "A"], "");
    assert_eq!(output.status.code(), Some(2));
}
