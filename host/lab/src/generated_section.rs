//! Documents with a part that a command writes, between two lines that say so.

/// What stands before and after the part; `None` where the document has no place for it.
fn split<'a>(document: &'a str, [begin, end]: [&str; 2]) -> Option<[&'a str; 2]> {
    let (before, rest) = document.split_once(begin)?;
    Some([before, rest.split_once(end)?.1])
}

/// Whether a document has the place.
pub fn has_place(document: &str, place: [&str; 2]) -> bool {
    split(document, place).is_some()
}

/// The document with its part replaced; `None` where it has no place for one.
pub fn replaced(document: &str, place: [&str; 2], text: &str) -> Option<String> {
    let [before, after] = split(document, place)?;
    let [begin, end] = place;
    Some(format!("{before}{begin}\n{text}{end}{after}"))
}
