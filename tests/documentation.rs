//! What the documentation says, tried.

#[path = "documentation/citations.rs"]
mod citations;

use std::fs;
use std::path::Path;

use softlimb::eval::{Scalar, batch};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn files_and_tests_named_in_the_documentation_exist() {
    for document in ["CONTRIBUTING.md", "docs/eval-batch.md", "docs/model.md", "docs/paper-map.md"] {
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
    let document = read("docs/model.md");
    assert!(citations::bare_names(&document).count() >= 9);
    for name in citations::bare_names(&document) {
        assert!(tests.contains(&format!("fn {name}(")), "docs/model.md names {name}, which is no test of the model");
    }
}

/// The lines between ```` ```<mark> ```` and the next fence.
fn block<'a>(document: &'a str, mark: &str) -> &'a str {
    let (_, rest) = document.split_once(&format!("```{mark}\n")).expect("the block begins");
    rest.split_once("```").expect("the block ends").0
}

#[test]
fn the_examples_of_the_batch_interface_are_what_it_answers() {
    let document = read("docs/eval-batch.md");
    for (asked, answered) in [("jsonl in", "jsonl out"), ("jsonl series in", "jsonl series out")] {
        let mut output = Vec::new();
        batch(block(&document, asked).as_bytes(), &mut output, Scalar::F64).expect("in memory");
        let found = String::from_utf8(output).expect("UTF-8");
        let shown = block(&document, answered);
        let compared = |text: &str| text.lines().map(without_effort).collect::<Vec<_>>();
        assert_eq!(compared(shown), compared(&found));
    }
}

/// A line without the values of `residual` and `iterations`: how hard the solver worked is its own business.
fn without_effort(line: &str) -> String {
    let key_of = |field: &str| field.split_once(':').map_or("", |(key, _)| key).to_owned();
    let effort = |field: &str| matches!(key_of(field).as_str(), "\"residual\"" | "\"iterations\"");
    let fields = line.trim_end_matches('}').split(',');
    fields.map(|field| if effort(field) { key_of(field) } else { field.to_owned() }).collect::<Vec<_>>().join(",")
}
