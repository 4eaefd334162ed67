//! Rust source as far as it runs in the product: without comments, text and tests.

/// `text` with comments, the inside of literals and `#[cfg(test)]` items blanked; lines keep their numbers.
pub(crate) fn product_code(text: &str) -> String {
    without_tests(&without_prose(text))
}

/// Numbers of the lines, from 1, on which `word` stands by itself.
///
/// A word that begins or ends like an identifier is not found inside a longer one; as the suffix of a number it is.
pub(crate) fn lines_with(code: &str, word: &str) -> Vec<usize> {
    let found = |line: &str| line.match_indices(word).any(|(at, _)| stands_alone(line, at, word));
    code.lines().enumerate().filter(|(_, line)| found(line)).map(|(index, _)| index + 1).collect()
}

fn stands_alone(line: &str, at: usize, word: &str) -> bool {
    let (before, after) = (&line[..at], &line[at + word.len()..]);
    let run = before.rsplit(|c| !in_name(c)).next().unwrap_or("");
    let starts = !word.starts_with(in_name) || run.is_empty() || run.starts_with(|c: char| c.is_ascii_digit());
    let ends = !word.ends_with(in_name) || !after.starts_with(in_name);
    starts && ends
}

fn in_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Blanks comments and the inside of string and character literals.
fn without_prose(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let named = code.ends_with(in_name);
        let prose = comment(rest).or_else(|| literal(rest, named));
        match prose {
            Some(length) => {
                code.extend(rest[..length].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
                rest = &rest[length..];
            }
            None => {
                code.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    code
}

/// Length of the comment `text` begins with.
fn comment(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    if !text.starts_with("/*") {
        return None;
    }
    let (mut depth, mut at) = (0_u32, 0);
    while at < text.len() {
        let step = if text[at..].starts_with("/*") {
            depth += 1;
            2
        } else if text[at..].starts_with("*/") {
            depth -= 1;
            2
        } else {
            text[at..].chars().next().map_or(1, char::len_utf8)
        };
        at += step;
        if depth == 0 {
            break;
        }
    }
    Some(at)
}

/// Length of the string or character literal `text` begins with; behind a name's letter a quote's prefix is part of the name.
fn literal(text: &str, named: bool) -> Option<usize> {
    let raw = text.strip_prefix("br").or_else(|| text.strip_prefix('r')).filter(|_| !named);
    if let Some(body) = raw {
        let marks = body.len() - body.trim_start_matches('#').len();
        if body[marks..].starts_with('"') {
            let end = format!("\"{}", "#".repeat(marks));
            let start = text.len() - body.len() + marks + 1;
            return Some(text[start..].find(&end).map_or(text.len(), |at| start + at + end.len()));
        }
    }
    match text.chars().next() {
        Some('"') => Some(quoted(text, '"')),
        // 'a' and '\n' are characters, 'a on its own is a lifetime.
        Some('\'') if text[1..].starts_with('\\') || text.chars().nth(2) == Some('\'') => Some(quoted(text, '\'')),
        _ => None,
    }
}

/// Length of a literal up to its closing quote, over escaped characters.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        if c == quote && !escaped {
            return at + c.len_utf8();
        }
        escaped = c == '\\' && !escaped;
    }
    text.len()
}

/// Blanks every item behind `#[cfg(test)]`.
fn without_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut kept = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(at) = rest.find(MARK) {
        kept.push_str(&rest[..at]);
        let end = at + MARK.len() + item(&rest[at + MARK.len()..]);
        kept.extend(rest[at..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        rest = &rest[end..];
    }
    kept + rest
}

/// Length of the item `code` begins with: to its semicolon or the end of its block.
fn item(code: &str) -> usize {
    let mut depth = 0_i32;
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 && matches!(c, ';' | '}') {
            return at + 1;
        }
    }
    code.len()
}

#[test]
fn comments_text_and_tests_are_no_code() {
    let text = r####"
//! println! in prose
/* nested /* println! */ println! */
let a = "println! \" println!"; let b = r#"println! " "#; let c = '"'; let d = '\'';
fn f<'a>(x: &'a str) { real(x) }
#[cfg(test)]
mod tests {
    fn g() { if true { println!() } }
}
#[cfg(test)]
const N: [u8; 2] = [println!(), 1];
println!();
"####;
    let code = product_code(text);
    assert_eq!(code.lines().count(), text.lines().count());
    assert_eq!(lines_with(&code, "println!"), [12]);
    assert_eq!(lines_with(&code, "real"), [5]);
}

#[test]
fn words_are_whole_words() {
    assert_eq!(lines_with("x.unwrap_or(1)\nx.unwrap()\ny.expect(2)", ".unwrap("), [2]);
    assert_eq!(lines_with("eprintln!()\nprintln!()", "println!"), [2]);
    assert_eq!(lines_with("let tomls = 1;\nuse toml::Spanned;", "toml"), [2]);
    assert_eq!(lines_with("1.0_f64\nas_f64()\nx as f64\nf64x", "f64"), [1, 3]);
}
