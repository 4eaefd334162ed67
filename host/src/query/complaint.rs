//! Errors of a line, in the words of JSON.

use serde_json::error::Category;

/// Words of the parser, and what a reader who knows JSON and `docs/reference/eval-batch.md` calls them.
const WORDS: [(&str, &str); 10] = [
    ("expected ident", "expected value"),
    ("unknown variant", "unknown value"),
    ("invalid type: sequence", "invalid type: array"),
    ("invalid type: map", "invalid type: object"),
    ("floating point", "number"),
    ("expected variant identifier", "expected a string"),
    ("expected f64", "expected a number"),
    ("expected a sequence", "expected an array"),
    ("expected u8", "expected 1 or 2"),
    ("EOF while parsing", "the line ends within"),
];

/// The message of the parser in plain words, with the column alone: the line is a file of its own to the parser.
pub(super) fn plain(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let message = text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
    let message = WORDS.iter().fold(message.to_owned(), |message, (from, to)| message.replace(from, to));
    // A number too large for a double is JSON all the same.
    let malformed = matches!(error.classify(), Category::Syntax | Category::Eof) && message != "number out of range";
    let prefix = if malformed { "not JSON: " } else { "" };
    match error.column() {
        0 => format!("{prefix}{message}"),
        column => format!("{prefix}{message} (column {column})"),
    }
}
