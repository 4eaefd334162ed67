//! One element per channel.

use core::ops::{Deref, DerefMut};

use crate::error::{EncodeError, ListLengthError, PayloadError};
use crate::message::MAX_CHANNELS;
use crate::wire::{Reader, Wire, Writer};

/// One to [`MAX_CHANNELS`] elements, in channel order. On the wire: a count byte, then the elements.
#[derive(Clone, Debug, PartialEq)]
pub struct List<T> {
    elements: heapless::Vec<T, MAX_CHANNELS>,
}

impl<T> List<T> {
    /// Collects the elements.
    ///
    /// # Errors
    /// [`ListLengthError`] for none or more than [`MAX_CHANNELS`].
    pub fn try_from_iter(source: impl IntoIterator<Item = T>) -> Result<Self, ListLengthError> {
        let mut elements = heapless::Vec::new();
        for element in source {
            elements.push(element).map_err(|_| ListLengthError)?;
        }
        if elements.is_empty() {
            return Err(ListLengthError);
        }
        Ok(Self { elements })
    }
}

impl<T: Clone> List<T> {
    /// Copies the elements.
    ///
    /// # Errors
    /// [`ListLengthError`] for none or more than [`MAX_CHANNELS`].
    pub fn from_slice(source: &[T]) -> Result<Self, ListLengthError> {
        Self::try_from_iter(source.iter().cloned())
    }
}

impl<T> Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.elements
    }
}

impl<T> DerefMut for List<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.elements
    }
}

impl<T: Wire> Wire for List<T> {
    const FIXED_LEN: usize = 1;
    const ELEMENT_LEN: usize = T::FIXED_LEN;

    fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
        let count = length(reader)?;
        let elements = &mut Reader::new(reader.pass(count * T::FIXED_LEN)?);
        Self::try_from_iter((0..count).map_while(|_| T::read(elements).ok())).map_err(|_| PayloadError::Truncated)
    }

    fn skip(reader: &mut Reader<'_>) -> Result<(), PayloadError> {
        let count = length(reader)?;
        reader.pass(count * T::FIXED_LEN).map(drop)
    }

    fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        // The length is at most MAX_CHANNELS, far below 256.
        (self.elements.len() as u8).write(writer)?;
        self.elements.iter().try_for_each(|element| element.write(writer))
    }
}

/// The count byte. A count beyond the limit is refused before its missing elements are.
fn length(reader: &mut Reader<'_>) -> Result<usize, PayloadError> {
    let count = u8::read(reader)?;
    let length = usize::from(count);
    if (1..=MAX_CHANNELS).contains(&length) { Ok(length) } else { Err(PayloadError::ListLength { count }) }
}
