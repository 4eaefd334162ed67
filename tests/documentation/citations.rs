//! Files and tests that the documentation names.

/// Everything in backticks that looks like a Rust file, with the function named behind it: `` `a/b.rs::name` ``.
pub(crate) fn cited(document: &str) -> Vec<(&str, Option<&str>)> {
    let quoted = document.split('`').skip(1).step_by(2);
    let files = quoted.map(|text| text.split_once("::").map_or((text, None), |(file, name)| (file, Some(name))));
    files.filter(|(file, _)| file.ends_with(".rs") && file.contains('/') && !file.contains(' ')).collect()
}

#[test]
fn files_and_tests_are_found_in_prose() {
    let text = "see `a/b.rs::name`, `fra_model::State`, `limb.rs` and `a/c.rs`";
    assert_eq!(cited(text), [("a/b.rs", Some("name")), ("a/c.rs", None)]);
}
