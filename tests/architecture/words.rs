//! Public names against the retired words of `CONTRIBUTING.md`.

/// The words of the table "Retired words" whose cell has no restriction in parentheses.
pub(crate) fn retired(page: &str) -> Vec<String> {
    let (_, table) = page.split_once("## Retired words").expect("the table of retired words");
    let rows = table
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| Do not") && !line.starts_with("| ---"));
    let cells = rows.filter_map(|row| row.trim_matches('|').split('|').next());
    let words = cells.filter(|cell| !cell.contains('(')).flat_map(|cell| cell.split(','));
    words.map(|word| word.trim().to_lowercase()).filter(|word| !word.is_empty() && !word.contains([' ', '.'])).collect()
}

/// Public items of the code whose name is one of the words, as `kind name`.
pub(crate) fn used(code: &str, words: &[String]) -> Vec<String> {
    let kinds = ["struct", "enum", "trait", "type", "mod", "fn", "const"];
    let items = code.lines().filter_map(|line| line.trim_start().strip_prefix("pub "));
    let named = items.filter_map(|item| {
        let (kind, rest) = item.strip_prefix("const fn ").map(|rest| ("fn", rest)).or_else(|| item.split_once(' '))?;
        let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?;
        kinds.contains(&kind).then_some((kind, name))
    });
    let found = named.filter(|(_, name)| words.contains(&name.to_lowercase()));
    found.map(|(kind, name)| format!("{kind} {name}")).collect()
}

#[test]
fn retired_words_are_read_and_found() {
    let words = retired(
        "text\n\n## Retired words\n\n| Do not write | Write |\n| --- | --- |\n| held | blocked |\n| two, jet | dual |\n| way (of x) | y |\n",
    );
    assert_eq!(words, ["held", "two", "jet"]);
    assert_eq!(
        used("pub struct Jet<T>;\npub fn hold() {}\n    pub const fn two() {}\nstruct Held;", &words),
        ["struct Jet", "fn two"]
    );
}
