//! What the documentation says, tried.

#[path = "documentation/citations.rs"]
mod citations;

use std::fs;
use std::path::Path;

use serde_json::Value;
use softlimb::eval::{Scalar, batch};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn files_and_tests_named_in_the_documentation_exist() {
    for document in [
        "CONTRIBUTING.md",
        "docs/evidence/accuracy.md",
        "docs/explanation/calibration.md",
        "docs/explanation/limb-synthesis.md",
        "docs/explanation/actuator-design.md",
        "docs/reference/eval-batch.md",
        "docs/explanation/fabrication.md",
        "docs/explanation/solid-elements.md",
        "docs/reference/hardware.md",
        "docs/explanation/model.md",
        "docs/reference/paper-map.md",
        "docs/explanation/payload.md",
        "docs/explanation/cross-section.md",
        "docs/explanation/solver-speed.md",
        "docs/explanation/statics.md",
        "docs/explanation/planning.md",
        "docs/explanation/tolerance.md",
        "docs/evidence/validation.md",
        "docs/explanation/workspace.md",
    ] {
        let text = read(document);
        for (file, name) in citations::cited(&text) {
            assert!(root().join(file).is_file(), "{document} names {file}, which does not exist");
            let there = name.is_none_or(|name| read(file).contains(&format!("fn {name}(")));
            assert!(there, "{document} names {name:?} of {file}, which has no such function");
        }
    }
}

#[test]
fn tests_of_the_model_named_without_their_file_exist() {
    let files = ["kinematics", "limits_and_anchors", "properties", "published_and_independent", "stress_integrals"];
    let tests: String = files.iter().map(|file| read(&format!("fra-model/tests/{file}.rs"))).collect();
    let document = read("docs/explanation/model.md");
    assert!(citations::bare_names(&document).count() >= 9);
    for name in citations::bare_names(&document) {
        assert!(tests.contains(&format!("fn {name}(")), "docs/explanation/model.md names {name}, which is no test of the model");
    }
}

#[test]
fn the_table_of_the_pins_is_that_of_the_code() {
    let table = softlimb_image_stm32f4::pins::Table.to_string();
    let document = read("docs/reference/hardware.md");
    let home = "`cargo run -p softlimb-image-stm32f4 --bin softlimb-stm32f4` prints this table";
    assert!(document.contains(&table), "docs/reference/hardware.md has another table of the pins; {home}:\n{table}");
}

/// The lines between ```` ```<mark> ```` and the next fence.
fn block<'a>(document: &'a str, mark: &str) -> &'a str {
    let (_, rest) = document.split_once(&format!("```{mark}\n")).expect("the block begins");
    rest.split_once("```").expect("the block ends").0
}

#[test]
fn the_examples_of_the_batch_interface_are_what_it_answers() {
    let document = read("docs/reference/eval-batch.md");
    for (asked, answered) in [("jsonl in", "jsonl out"), ("jsonl series in", "jsonl series out")] {
        let mut output = Vec::new();
        batch(block(&document, asked).as_bytes(), &mut output, Scalar::F64).expect("in memory");
        let found = String::from_utf8(output).expect("UTF-8");
        let shown = block(&document, answered);
        assert_eq!(shown.lines().count(), found.lines().count());
        for (shown, found) in shown.lines().zip(found.lines()) {
            let parse = |line: &str| serde_json::from_str::<Value>(line).expect("a JSON object");
            assert!(agree(&parse(shown), &parse(found)), "the page shows\n{shown}\nand the answer is\n{found}");
        }
    }
}

#[test]
fn answers_that_differ_are_told_apart() {
    let parse = |text: &str| serde_json::from_str::<Value>(text).expect("JSON");
    let shown = parse(r#"{"a": [1.0, {"b": 2.0}], "iterations": 3, "status": "ok"}"#);
    assert!(agree(&shown, &parse(r#"{"a": [1.0000000001, {"b": 2.0}], "iterations": 9, "status": "ok"}"#)));
    for other in [
        r#"{"a": [1.0001, {"b": 2.0}], "iterations": 3, "status": "ok"}"#,
        r#"{"a": [1.0], "iterations": 3, "status": "ok"}"#,
        r#"{"a": [1.0, {"c": 2.0}], "iterations": 3, "status": "ok"}"#,
        r#"{"a": [1.0, {"b": 2.0}], "iterations": 3, "status": "no"}"#,
        r#"{"a": [1.0, {"b": 2.0}], "status": "ok"}"#,
    ] {
        assert!(!agree(&shown, &parse(other)), "{other}");
    }
}

/// Equal but for the last digits of numbers, and for `residual` and `iterations`: how hard the solver worked is its own business.
fn agree(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().expect("a float"), b.as_f64().expect("a float"));
            (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-6)
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| agree(a, b)),
        (Value::Object(a), Value::Object(b)) => {
            let effort = |key: &str| matches!(key, "residual" | "iterations");
            let same = |(key, a): (&String, &Value)| b.get(key).is_some_and(|b| effort(key) || agree(a, b));
            a.len() == b.len() && a.iter().all(same)
        }
        (a, b) => a == b,
    }
}
