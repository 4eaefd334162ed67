//! `softlimb-lab design`.

use std::io::Write;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use softlimb_design::actuators::{Budget, Problem, solve};

/// A problem of eq. (14).
const EXTENSION: &str = include_str!("../../design/tests/problems/extension.json");

fn softlimb(problem: &str, more: &[&str], input: &str) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("reach.json");
    std::fs::write(&file, problem).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb-lab"));
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
fn methods_are_compared_on_the_same_problem() {
    let files = ["--evaluations", "3000", "--seeds", "2", "--tsv", "c.tsv", "--svg", "c.svg"];
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
        serde_json::from_slice(&softlimb(EXTENSION, &["--evaluations", "50", "--json"], "").stdout).expect("JSON");
    let problem = Problem::read(EXTENSION).expect("a problem");
    let answer = solve(&problem, &Budget::default()).expect("an answer");
    let answer = serde_json::to_value(answer).expect("JSON");
    let [ours, swarm] = [0, 1].map(|row| &table["rows"][row]);
    assert_eq!((&ours["method"], &swarm["method"]), (&Value::from("projection"), &Value::from("pso")));
    assert_eq!(ours["end"]["model_solves"], answer["cost"]["model_solves"]);
    assert_eq!(ours["end"]["objective"], answer["objective"]);
    assert_eq!((&swarm["end"]["evaluations"], &swarm["end"]["model_solves"]), (&Value::from(50), &Value::from(100)));
    assert_eq!((&ours["solved"], &swarm["solved"]), (&Value::from(1), &Value::from(0)));
}

/// The lines of the published picture: each piece goes right or down, but where steps are finer than a pixel. Down is positive.
#[test]
fn least_objectives_of_the_picture_never_rise() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/evidence/design-comparison.svg");
    let picture = std::fs::read_to_string(file).expect("the picture");
    let place = |point: &str| -> Vec<f64> { point.split(' ').map(|part| part.parse().expect("a number")).collect() };
    let mut lines = 0;
    for line in picture.lines().filter(|line| line.contains(" solid\"") && line.contains('L')) {
        let path = line.split(" d=\"M").nth(1).and_then(|rest| rest.split('"').next()).expect("a path");
        let points: Vec<Vec<f64>> = path.split('L').map(place).collect();
        let is_step = |pair: &[Vec<f64>]| {
            let [across, down] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
            (0.0..3.0).contains(&across.min(down))
        };
        assert!(points.windows(2).all(is_step), "{line}");
        lines += 1;
    }
    assert!(lines > 100, "{lines} lines");
}
