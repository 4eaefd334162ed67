//! The documentation against the code: pages, links, cited files and tests, examples.

#[path = "documentation/citations.rs"]
mod citations;
#[path = "documentation/pages.rs"]
mod pages;
#[path = "documentation/retired.rs"]
mod retired;

use std::collections::BTreeSet;

use std::fs;
use std::path::Path;

use serde_json::Value;
use softlimb::query::{Scalar, batch};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Text of every page of the documentation, by its path in the repository. The change log tells of files that are gone.
fn documents() -> Vec<(String, String)> {
    let paths = pages::markdown(root()).into_iter().map(|path| path.to_str().expect("UTF-8").to_owned());
    let paths: Vec<String> = paths.filter(|path| path != "CHANGELOG.md").collect();
    for expected in ["README.md", "CONTRIBUTING.md", "docs/explanation/model.md", "protocol/SPEC.md"] {
        assert!(paths.iter().any(|path| path == expected), "{expected} is not among the pages");
    }
    paths.into_iter().map(|path| (path.clone(), read(&path))).collect()
}

#[test]
fn summary_lists_every_page_once() {
    let book = root().join("docs");
    let listed = pages::links(&read("docs/SUMMARY.md"));
    let unique: BTreeSet<_> = listed.iter().cloned().collect();
    let there = pages::markdown(&book).into_iter().map(|path| path.to_str().expect("UTF-8").to_owned());
    let there: BTreeSet<_> = there.filter(|path| path != "SUMMARY.md").collect();
    assert_eq!(unique.len(), listed.len(), "docs/SUMMARY.md lists a page twice");
    let (missing, stale): (Vec<_>, Vec<_>) = (there.difference(&unique).collect(), unique.difference(&there).collect());
    assert!(missing.is_empty(), "docs/SUMMARY.md lacks {missing:?}");
    assert!(stale.is_empty(), "docs/SUMMARY.md lists pages that do not exist: {stale:?}");
}

#[test]
fn links_of_the_documentation_are_whole() {
    let mut count = 0;
    let mut broken = Vec::new();
    for (path, text) in documents() {
        for link in pages::links(&text) {
            count += 1;
            broken.extend(pages::broken(root(), Path::new(&path), &link));
        }
    }
    assert!(count > 300, "only {count} links were found");
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn files_and_tests_named_in_the_documentation_exist() {
    for (document, text) in documents() {
        let beside = Path::new(&document).parent().expect("a folder");
        for (file, name) in citations::cited(&text) {
            // From the root, or as a package's own page says it.
            let there = [root().join(file), root().join(beside).join(file)].into_iter().find(|path| path.is_file());
            let Some(path) = there else { panic!("{document} names {file}, which does not exist") };
            let source = fs::read_to_string(path).expect("UTF-8");
            let there = name.is_none_or(|name| source.contains(&format!("fn {name}(")));
            assert!(there, "{document} names {name:?} of {file}, which has no such function");
        }
    }
}

#[test]
fn tests_named_without_their_file_exist() {
    let functions = citations::functions(root());
    assert!(functions.len() > 1000, "only {} functions were found", functions.len());
    let mut count = 0;
    for (document, text) in documents() {
        for name in citations::bare_names(&text) {
            count += 1;
            assert!(functions.contains(name), "{document} names {name}, which is no function of the workspace");
        }
    }
    assert!(count > 100, "only {count} names of tests were found");
}

#[test]
fn documented_commands_are_of_this_version() {
    let retired = retired::rows(&read("host/src/cli/retired.rs"));
    assert!(retired.len() > 10, "only {} retired forms were found", retired.len());
    let found = documents().into_iter().flat_map(|(path, text)| {
        retired::used(&text, &retired).into_iter().map(|used| format!("{path}: {used}")).collect::<Vec<_>>()
    });
    let found: Vec<String> = found.collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn table_of_the_pins_is_that_of_the_code() {
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
fn examples_of_the_batch_interface_are_what_it_answers() {
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
