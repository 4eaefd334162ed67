//! Files and tests that the documentation names.

/// Everything in backticks that looks like a Rust file, with the function named behind it: `` `a/b.rs::name` ``.
pub(crate) fn cited(document: &str) -> Vec<(&str, Option<&str>)> {
    let quoted = document.split('`').skip(1).step_by(2);
    let files = quoted.map(|text| text.split_once("::").map_or((text, None), |(file, name)| (file, Some(name))));
    files.filter(|(file, _)| file.ends_with(".rs") && file.contains('/') && !file.contains(' ')).collect()
}

/// Everything in backticks that has the look of a test's name without its file: four underscores or more.
pub(crate) fn bare_names(document: &str) -> impl Iterator<Item = &str> {
    let quoted = document.split('`').skip(1).step_by(2);
    let in_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    quoted.filter(move |text| text.matches('_').count() >= 4 && text.chars().all(in_name))
}

#[test]
fn files_and_tests_are_found_in_prose() {
    let text = "see `a/b.rs::name`, `fra_model::State`, `limb.rs` and `a/c.rs`; `what_it_says_is_so`, `axial_stretch`";
    assert_eq!(cited(text), [("a/b.rs", Some("name")), ("a/c.rs", None)]);
    assert_eq!(bare_names(text).collect::<Vec<_>>(), ["what_it_says_is_so"]);
}
