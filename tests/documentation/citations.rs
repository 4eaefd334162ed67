//! Files and tests that the documentation names.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

/// Everything in backticks that looks like a Rust file, with the function named behind it: `` `a/b.rs::name` ``.
pub(crate) fn cited(document: &str) -> Vec<(&str, Option<&str>)> {
    let quoted = document.split('`').skip(1).step_by(2);
    let files = quoted.map(|text| text.split_once("::").map_or((text, None), |(file, name)| (file, Some(name))));
    files.filter(|(file, _)| file.ends_with(".rs") && file.contains('/') && !file.contains(' ')).collect()
}

/// Everything in backticks that has the look of a test's name without its file: four underscores or more, and no quantity per another.
pub(crate) fn bare_names(document: &str) -> impl Iterator<Item = &str> {
    let quoted = document.split('`').skip(1).step_by(2);
    let in_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    quoted.filter(move |text| text.matches('_').count() >= 4 && !text.contains("_per_") && text.chars().all(in_name))
}

/// Names of all functions below a folder, but for built files.
pub(crate) fn functions(folder: &Path) -> HashSet<String> {
    let mut found = HashSet::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry")) {
        let (path, name) = (entry.path(), entry.file_name());
        if entry.file_type().expect("a type").is_dir() {
            let skipped = name == "target" || name.to_string_lossy().starts_with('.');
            found.extend(if skipped { HashSet::new() } else { functions(&path) });
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("UTF-8");
            let named = text.split("fn ").skip(1).filter_map(|rest| rest.split(['(', '<']).next());
            found.extend(named.map(str::to_owned));
        }
    }
    found
}

#[test]
fn files_and_tests_are_found_in_prose() {
    let text = "see `a/b.rs::name`, `fra_model::State`, `limb.rs` and `a/c.rs`; `what_it_says_is_so`, `axial_stretch`";
    assert_eq!(cited(text), [("a/b.rs", Some("name")), ("a/c.rs", None)]);
    assert_eq!(bare_names(text).collect::<Vec<_>>(), ["what_it_says_is_so"]);
}
