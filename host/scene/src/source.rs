//! The text of a scene and places in it.

use std::fs::File;
use std::io::Read;
use std::ops::{Deref, Range};
use std::path::Path;
use std::sync::Arc;

use super::error::{SceneError, Unreadable};

/// Largest scene file that is read, bytes.
pub const SCENE_BYTES_MAX: u64 = 1 << 20;

/// A range of bytes in the text of the scene it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    start: usize,
    end: usize,
}

impl Span {
    /// The place of a default in a table that the scene does not have.
    pub const NOWHERE: Self = Self { start: 0, end: 0 };

    /// The bytes, as offsets into [`Scene::source_text`](super::Scene::source_text).
    pub fn range(self) -> Range<usize> {
        self.start..self.end
    }
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Self {
        Self { start: range.start, end: range.end.max(range.start) }
    }
}

/// A checked value and where the scene says it. A value the scene leaves to its default is located at the header of its table,
/// or [`Span::NOWHERE`] if that is left out too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located<T> {
    /// The value, in SI units where it has one.
    pub value: T,
    /// Its place in the file.
    pub span: Span,
}

impl<T> Located<T> {
    /// The same place with another value.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Located<U> {
        Located { value: f(self.value), span: self.span }
    }
}

impl<T> Deref for Located<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// Name and text of a scene, shared by the scene and its diagnostics.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) name: Arc<str>,
    pub(super) text: Arc<str>,
}

impl Source {
    pub(super) fn new(name: &str, text: &str) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// Reads a file of at most [`SCENE_BYTES_MAX`] bytes of UTF-8.
    pub(super) fn read(path: &Path) -> Result<Self, SceneError> {
        let text = read_text(path).map_err(|reason| SceneError::Unreadable { path: path.to_owned(), reason })?;
        Ok(Self::new(&path.display().to_string(), &text))
    }

    /// FNV-1a of the text, 64 bits.
    pub(super) fn hash(&self) -> u64 {
        fnv1a(self.text.as_bytes())
    }

    /// Line and column (in characters) of a byte offset, both from 1.
    pub(super) fn position(&self, offset: usize) -> (usize, usize) {
        let before = &self.text[..boundary_before(&self.text, offset)];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (1 + before.matches('\n').count(), 1 + before[line_start..].chars().count())
    }
}

/// The last boundary between characters at or before an offset, within the text.
pub(super) fn boundary_before(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

/// Reads a file of at most [`SCENE_BYTES_MAX`] bytes of UTF-8.
pub(super) fn read_text(path: &Path) -> Result<String, Unreadable> {
    String::from_utf8(read_bounded(path)?).map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..offset].iter().filter(|b| **b == b'\n').count();
        Unreadable::NotUtf8 { offset, line }
    })
}

/// Reads a file, by its size on disk first: a file of 100 MB is refused before a byte of it is read.
fn read_bounded(path: &Path) -> Result<Vec<u8>, Unreadable> {
    let file = File::open(path).map_err(|error| Unreadable::Io(error.kind()))?;
    let metadata = file.metadata().map_err(|error| Unreadable::Io(error.kind()))?;
    if metadata.is_dir() {
        return Err(Unreadable::Directory);
    }
    if metadata.len() > SCENE_BYTES_MAX {
        return Err(Unreadable::TooLarge);
    }
    let mut bytes = Vec::new();
    // Pipes and devices have no size; one byte more than allowed is enough to know.
    file.take(SCENE_BYTES_MAX + 1).read_to_end(&mut bytes).map_err(|error| Unreadable::Io(error.kind()))?;
    if bytes.len() as u64 > SCENE_BYTES_MAX { Err(Unreadable::TooLarge) } else { Ok(bytes) }
}

/// FNV-1a, 64 bits.
pub(super) fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fnv1a_check_values() {
        // Test vectors of draft-eastlake-fnv.
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn positions_count_characters_from_one() {
        let source = Source::new("x", "ab\nµm = 1\n");
        assert_eq!(source.position(0), (1, 1));
        assert_eq!(source.position(3), (2, 1));
        assert_eq!(source.position(5), (2, 2), "µ is two bytes and one character");
        assert_eq!(source.position(4), (2, 1), "inside a character counts as its start");
        assert_eq!(source.position(999), (3, 1));
    }
}
