//! On which line of a JSON text a value stands: the parser of values does not keep it.

/// The line, from 1, where the value of a path like `segments[0].bounds.wall_m[1]` begins, or its nearest enclosing value that is there.
/// `text` is valid JSON.
pub(crate) fn line_of(text: &str, path: &str) -> usize {
    let mut place = Place { text: text.as_bytes(), at: 0 };
    place.space();
    let mut best = place.at;
    for step in steps(path) {
        let found = match step {
            Step::Field(name) => place.enter_field(name),
            Step::Item(index) => place.enter_item(index),
        };
        if !found {
            break;
        }
        best = place.at;
    }
    1 + text.as_bytes()[..best].iter().filter(|byte| **byte == b'\n').count()
}

enum Step<'a> {
    Field(&'a str),
    Item(usize),
}

fn steps(path: &str) -> impl Iterator<Item = Step<'_>> {
    path.split(['.', '[']).filter(|part| !part.is_empty()).map(|part| match part.strip_suffix(']') {
        Some(index) => Step::Item(index.parse().unwrap_or(usize::MAX)),
        None => Step::Field(part),
    })
}

struct Place<'a> {
    text: &'a [u8],
    at: usize,
}

impl Place<'_> {
    fn byte(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(0)
    }

    fn space(&mut self) {
        while self.byte().is_ascii_whitespace() {
            self.at += 1;
        }
    }

    /// From an object to the value of one of its fields.
    fn enter_field(&mut self, name: &str) -> bool {
        self.enter(b'{', |place, _| {
            let begin = place.at;
            place.skip();
            let key = place.text.get(begin + 1..place.at - 1).unwrap_or_default();
            place.space();
            place.at += 1; // the colon
            place.space();
            key == name.as_bytes()
        })
    }

    /// From an array to one of its items.
    fn enter_item(&mut self, index: usize) -> bool {
        self.enter(b'[', |_, item| item == index)
    }

    /// Goes through an object or array until `here` says that the value at hand is the one.
    fn enter(&mut self, open: u8, here: impl Fn(&mut Self, usize) -> bool) -> bool {
        if self.byte() != open {
            return false;
        }
        let mut item = 0;
        loop {
            self.at += 1; // the bracket, or the comma
            self.space();
            if matches!(self.byte(), b'}' | b']' | 0) {
                return false;
            }
            if here(self, item) {
                return true;
            }
            self.skip();
            self.space();
            item += 1;
            if self.byte() != b',' {
                return false;
            }
        }
    }

    /// Past one value.
    fn skip(&mut self) {
        let mut depth = 0;
        loop {
            match self.byte() {
                b'"' => self.skip_string(),
                b'{' | b'[' => {
                    depth += 1;
                    self.at += 1;
                }
                b'}' | b']' if depth > 0 => {
                    depth -= 1;
                    self.at += 1;
                }
                0 => return,
                _ if depth == 0 => {
                    while !matches!(self.byte(), b',' | b'}' | b']' | 0) && !self.byte().is_ascii_whitespace() {
                        self.at += 1;
                    }
                }
                _ => self.at += 1,
            }
            if depth == 0 {
                return;
            }
        }
    }

    fn skip_string(&mut self) {
        self.at += 1;
        while !matches!(self.byte(), b'"' | 0) {
            self.at += if self.byte() == b'\\' { 2 } else { 1 };
        }
        self.at += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::line_of;

    const TEXT: &str = r#"{
  "a\"]": [1, "}\\",
    {"b": null,
     "c": [-1e3,
       2.5]}],
  "d": {}, "e":
    true
}"#;

    #[test]
    fn values_have_the_line_they_begin_on() {
        for (path, line) in [("", 1), ("d", 6), ("e", 7), ("missing", 1), ("d.x", 6)] {
            assert_eq!(line_of(TEXT, path), line, "{path}");
        }
        let text = TEXT.replace("a\\\"]", "a");
        for (path, line) in [("a", 2), ("a[1]", 2), ("a[2]", 3), ("a[2].b", 3), ("a[2].c[0]", 4), ("a[2].c[1]", 5)] {
            assert_eq!(line_of(&text, path), line, "{path}");
        }
        assert_eq!((line_of(&text, "a[9]"), line_of(&text, "a[2].c[7]")), (2, 4));
    }
}
