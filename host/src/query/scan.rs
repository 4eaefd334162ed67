//! A fast reader of JSON as programs usually write it.
//!
//! It accepts a part of what `serde_json` accepts, with the same result: no `null`, no empty lists, strings without escapes. Of any
//! other text it says nothing, and `serde_json` decides.

use std::fmt;
use std::mem;

use serde::de::{self, Deserialize, DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::forward_to_deserialize_any;

/// The value in a line; `None` where `serde_json` has to decide.
pub(super) fn read<'a, T: Deserialize<'a>>(line: &'a [u8]) -> Option<T> {
    let mut scan = Scan { text: std::str::from_utf8(line).ok()?, at: 0 };
    let value = T::deserialize(&mut scan).ok()?;
    scan.peek().is_none().then_some(value)
}

/// A text, read up to a byte.
struct Scan<'a> {
    text: &'a str,
    at: usize,
}

/// The reader does not know this text.
#[derive(Debug)]
struct Unknown;

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("unknown")
    }
}

impl std::error::Error for Unknown {}

impl de::Error for Unknown {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

impl<'a> Scan<'a> {
    /// The next byte that is no white space.
    #[inline(always)]
    fn peek(&mut self) -> Option<u8> {
        while self.skip(b" \t\r\n") {}
        self.text.as_bytes().get(self.at).copied()
    }

    /// Passes over one of some bytes, if it is next.
    #[inline(always)]
    fn skip(&mut self, bytes: &[u8]) -> bool {
        let is_next = self.text.as_bytes().get(self.at).is_some_and(|byte| bytes.contains(byte));
        self.at += usize::from(is_next);
        is_next
    }

    #[inline(always)]
    fn token(&mut self, token: u8) -> Result<(), Unknown> {
        self.peek();
        if self.skip(&[token]) { Ok(()) } else { Err(Unknown) }
    }

    /// The text between two quotes, as it stands there: with a quote that is escaped it ends too early, behind a backslash.
    #[inline(always)]
    fn word(&mut self) -> Result<&'a str, Unknown> {
        self.token(b'"')?;
        let rest = self.text.get(self.at..).ok_or(Unknown)?;
        let end = rest.bytes().position(|byte| byte == b'"').ok_or(Unknown)?;
        self.at += end + 1;
        rest.get(..end).ok_or(Unknown)
    }

    #[inline(always)]
    fn number(&mut self) -> Result<&'a str, Unknown> {
        self.peek();
        let start = self.at;
        self.skip(b"-");
        // Nothing but the point follows a zero in front.
        if !self.skip(b"0") {
            self.digits()?;
        }
        if self.skip(b".") {
            self.digits()?;
        }
        if self.skip(b"eE") {
            self.skip(b"+-");
            self.digits()?;
        }
        self.text.get(start..self.at).ok_or(Unknown)
    }

    #[inline(always)]
    fn digits(&mut self) -> Result<(), Unknown> {
        let start = self.at;
        while self.text.as_bytes().get(self.at).is_some_and(u8::is_ascii_digit) {
            self.at += 1;
        }
        if self.at > start { Ok(()) } else { Err(Unknown) }
    }
}

impl<'de> Deserializer<'de> for &mut Scan<'de> {
    type Error = Unknown;

    /// A string or a natural number.
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unknown> {
        if self.peek() != Some(b'"') {
            return visitor.visit_u64(self.number()?.parse().map_err(|_| Unknown)?);
        }
        let word = self.word()?;
        let is_plain = word.bytes().all(|byte| byte >= b' ' && byte != b'\\');
        if is_plain { visitor.visit_borrowed_str(word) } else { Err(Unknown) }
    }

    #[inline]
    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unknown> {
        // A number too large is none of `serde_json`.
        let number = self.number()?.parse().ok().filter(|number: &f64| number.is_finite());
        visitor.visit_f64(number.ok_or(Unknown)?)
    }

    #[inline]
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unknown> {
        visitor.visit_some(self)
    }

    /// No name of a field or a variant holds an escape.
    #[inline]
    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unknown> {
        visitor.visit_borrowed_str(self.word()?)
    }

    #[inline]
    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unknown> {
        self.token(b'{')?;
        let value = visitor.visit_map(Items { scan: self, is_first: true })?;
        self.token(b'}').map(|()| value)
    }

    #[inline]
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unknown> {
        self.deserialize_map(visitor)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unknown> {
        self.token(b'[')?;
        let value = visitor.visit_seq(Items { scan: self, is_first: true })?;
        self.token(b']').map(|()| value)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Unknown> {
        self.deserialize_seq(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 char str string bytes byte_buf unit unit_struct newtype_struct
        tuple_struct enum ignored_any
    }
}

/// What stands in brackets, between commas.
struct Items<'s, 'a> {
    scan: &'s mut Scan<'a>,
    is_first: bool,
}

impl Items<'_, '_> {
    #[inline(always)]
    fn has_next(&mut self) -> bool {
        mem::take(&mut self.is_first) || self.scan.token(b',').is_ok()
    }
}

impl<'a> MapAccess<'a> for Items<'_, 'a> {
    type Error = Unknown;

    #[inline]
    fn next_key_seed<K: DeserializeSeed<'a>>(&mut self, seed: K) -> Result<Option<K::Value>, Unknown> {
        if self.has_next() { seed.deserialize(&mut *self.scan).map(Some) } else { Ok(None) }
    }

    #[inline]
    fn next_value_seed<V: DeserializeSeed<'a>>(&mut self, seed: V) -> Result<V::Value, Unknown> {
        self.scan.token(b':')?;
        seed.deserialize(&mut *self.scan)
    }
}

impl<'a> SeqAccess<'a> for Items<'_, 'a> {
    type Error = Unknown;

    fn next_element_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<Option<T::Value>, Unknown> {
        if self.has_next() { seed.deserialize(&mut *self.scan).map(Some) } else { Ok(None) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn same<T: PartialEq + fmt::Debug + de::DeserializeOwned>(text: &str, is_known: bool) {
        let scanned: Option<T> = read(text.as_bytes());
        assert_eq!(scanned.is_some(), is_known, "{text}");
        if is_known {
            assert_eq!(scanned, serde_json::from_str(text).ok(), "{text}");
        }
    }

    #[test]
    fn usual_text_is_read_as_by_serde_json() {
        for text in ["0", "-0", "12", "0.1", "-1.50e-7", "1E+3", "2e0", " 18446744073709551615\n", "4.9e-324"] {
            same::<f64>(text, true);
        }
        for text in ["12", "0", "\"a b\"", "\"\u{e9}\"", "\"\"", " \"x\" "] {
            same::<Value>(text, true);
        }
        same::<[f64; 3]>("[1, 2.5 ,\t3]", true);
        same::<Vec<u8>>("[1,255]", true);
    }

    #[test]
    fn other_text_is_left_to_serde_json() {
        for text in
            ["", "-", "+1", "01", "-00", ".5", "1.", "1.e3", "1e", "1e+", "1e999", "NaN", "inf", "1 2", "0x1", "1_0"]
        {
            same::<f64>(text, false);
        }
        for text in ["null", "true", "-1", "1.0", "\"\\n\"", "\"a\\\"b\"", "\"a\nb\"", "\"a", "{}", "[]", "1,"] {
            same::<Value>(text, false);
        }
        for text in ["[1,2]", "[1,2,3,4]", "[1,2,3", "[1,2,3,]", "[,1,2,3]", "[1 2,3,4]", "{1,2,3}"] {
            same::<[f64; 3]>(text, false);
        }
        assert_eq!(read::<Value>(b"\"\xff\""), None);
    }
}
