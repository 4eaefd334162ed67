//! Little-endian fields: how one value becomes bytes and back.

use crate::error::{EncodeError, PayloadError};

/// Eats a payload from the front.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A reader over a whole payload.
    pub(crate) fn new(payload: &'a [u8]) -> Self {
        Self { rest: payload }
    }

    /// Bytes that are left.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Passes over bytes, and returns them.
    pub(crate) fn pass(&mut self, count: usize) -> Result<&'a [u8], PayloadError> {
        let (passed, rest) = self.rest.split_at_checked(count).ok_or(PayloadError::Truncated)?;
        self.rest = rest;
        Ok(passed)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], PayloadError> {
        let (head, rest) = self.rest.split_first_chunk().ok_or(PayloadError::Truncated)?;
        self.rest = rest;
        Ok(*head)
    }
}

/// Fills a buffer from the front.
pub(crate) struct Writer<'a> {
    buffer: &'a mut [u8],
    len: usize,
}

impl<'a> Writer<'a> {
    /// A writer at the start of `buffer`.
    pub(crate) fn new(buffer: &'a mut [u8]) -> Self {
        Self { buffer, len: 0 }
    }

    /// Appends `bytes`, or nothing when they do not fit.
    pub(crate) fn put(&mut self, bytes: &[u8]) -> Result<(), EncodeError> {
        let end = self.len + bytes.len();
        let place = self.buffer.get_mut(self.len..end).ok_or(EncodeError::BufferTooSmall)?;
        place.copy_from_slice(bytes);
        self.len = end;
        Ok(())
    }

    /// Bytes written so far.
    pub(crate) fn written(&self) -> &[u8] {
        self.buffer.get(..self.len).unwrap_or_default()
    }
}

/// A value with a place in a payload.
pub(crate) trait Wire: Sized {
    /// Bytes that are always there.
    const FIXED_LEN: usize;
    /// Bytes per element, for lists.
    const ELEMENT_LEN: usize = 0;

    /// Takes the value from the front of a payload.
    fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError>;

    /// Passes over the value, with the errors of [`read`](Self::read).
    fn skip(reader: &mut Reader<'_>) -> Result<(), PayloadError> {
        Self::read(reader).map(drop)
    }

    /// Appends the value to a payload.
    fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError>;
}

/// Largest encoding of a value.
pub(crate) const fn max_len<T: Wire>() -> usize {
    T::FIXED_LEN + T::ELEMENT_LEN * crate::message::MAX_CHANNELS
}

macro_rules! little_endian {
    ($($number:ty),*) => {$(
        impl Wire for $number {
            const FIXED_LEN: usize = size_of::<$number>();

            fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
                reader.take().map(<$number>::from_le_bytes)
            }

            fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                writer.put(&self.to_le_bytes())
            }
        }
    )*};
}

little_endian!(u8, u16, u32, u64, i8, i16, i32, f32);
