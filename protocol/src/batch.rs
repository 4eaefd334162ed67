//! Several records of one kind in one message, each as long as its lists.

use core::fmt;
use core::marker::PhantomData;

use crate::codec::MAX_PAYLOAD_LEN;
use crate::error::{EncodeError, PayloadError};
use crate::message::{KnotStep, Outputs};
use crate::wire::{Reader, Wire, Writer};

/// Size of the longest content, bytes: a payload less the count and a session.
const CAPACITY: usize = MAX_PAYLOAD_LEN - 3;

/// One record or more. On the wire: a count byte, then the records. Held as those bytes, which are shorter than the records.
pub struct Batch<T> {
    count: u8,
    len: usize,
    bytes: [u8; CAPACITY],
    records: PhantomData<fn() -> T>,
}

impl<T> Batch<T> {
    /// An empty batch. It cannot be encoded before it holds a record.
    #[must_use]
    pub const fn new() -> Self {
        Self { count: 0, len: 0, bytes: [0; CAPACITY], records: PhantomData }
    }

    /// Number of records.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count as usize
    }

    /// Whether the batch is empty.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Removes all records.
    pub const fn clear(&mut self) {
        (self.count, self.len) = (0, 0);
    }

    fn content(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or_default()
    }
}

#[allow(private_bounds, reason = "sealed: the interface table is the only source of records")]
impl<T: Wire> Batch<T> {
    /// Appends a record.
    ///
    /// # Errors
    /// [`EncodeError::BufferTooSmall`] where no frame could hold so many; nothing is appended then.
    pub fn push(&mut self, record: &T) -> Result<(), EncodeError> {
        let count = self.count.checked_add(1).ok_or(EncodeError::BufferTooSmall)?;
        let writer = &mut Writer::new(self.bytes.get_mut(self.len..).unwrap_or_default());
        record.write(writer)?;
        self.len += writer.written().len();
        self.count = count;
        Ok(())
    }

    /// The records in order.
    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        let mut reader = Reader::new(self.content());
        // The bytes were written or checked by this type, so reading them cannot fail.
        (0..self.count).map_while(move |_| T::read(&mut reader).ok())
    }
}

impl<T> Default for Batch<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Clone for Batch<T> {
    fn clone(&self) -> Self {
        Self { ..*self }
    }
}

impl<T> PartialEq for Batch<T> {
    fn eq(&self, other: &Self) -> bool {
        self.count == other.count && self.content() == other.content()
    }
}

impl<T: Wire + fmt::Debug> fmt::Debug for Batch<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl<T: Wire> Wire for Batch<T> {
    const FIXED_LEN: usize = 1;

    fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
        let count = u8::read(reader)?;
        if count == 0 {
            return Err(PayloadError::ListLength { count });
        }
        let whole = reader.rest();
        for _ in 0..count {
            T::skip(reader)?;
        }
        let content = whole.get(..whole.len() - reader.rest().len()).unwrap_or_default();
        // Only an invalid payload is longer than the longest message with a batch.
        let mut batch = Self { count, len: content.len(), ..Self::new() };
        batch.bytes.get_mut(..content.len()).ok_or(PayloadError::ListLength { count })?.copy_from_slice(content);
        Ok(batch)
    }

    fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        self.count.write(writer)?;
        writer.put(self.content())
    }
}

/// Records with lists of `channels` elements that fit into a message of `fixed` bytes beside them.
const fn fitting<T: Wire>(fixed: usize, channels: usize) -> usize {
    (MAX_PAYLOAD_LEN - fixed) / (T::FIXED_LEN + T::ELEMENT_LEN * channels)
}

/// A record of [`Knots`] in its place: a device copies no list of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInPlace<'a> {
    /// As in [`KnotStep`].
    pub step_us: u16,
    /// As in [`KnotStep`].
    pub outputs: Outputs,
    steps: &'a [[u8; 2]],
}

impl<'a> StepInPlace<'a> {
    fn read(reader: &mut Reader<'a>) -> Result<Self, PayloadError> {
        let (step_us, outputs) = (u16::read(reader)?, Outputs::read(reader)?);
        let count = u8::read(reader)?;
        Ok(Self { step_us, outputs, steps: reader.pass(2 * usize::from(count))?.as_chunks().0 })
    }

    /// Steps of the channels.
    pub fn steps(self) -> impl ExactSizeIterator<Item = i16> + 'a {
        self.steps.iter().map(|&bytes| i16::from_le_bytes(bytes))
    }
}

impl Batch<KnotStep> {
    /// The records in order, in their places.
    pub fn in_place(&self) -> impl Iterator<Item = StepInPlace<'_>> {
        let mut reader = Reader::new(self.content());
        (0..self.count).map_while(move |_| StepInPlace::read(&mut reader).ok())
    }
}

impl crate::message::Knots {
    /// The most knots of so many channels in one frame.
    #[must_use]
    pub const fn most(channels: usize) -> usize {
        fitting::<KnotStep>(<Self as Wire>::FIXED_LEN, channels)
    }
}

impl crate::message::Samples {
    /// The most samples of so many channels in one frame.
    #[must_use]
    pub const fn most(channels: usize) -> usize {
        fitting::<crate::message::Sample>(<Self as Wire>::FIXED_LEN, channels)
    }
}

impl crate::message::Ticks {
    /// The most ticks of so many channels in one frame.
    #[must_use]
    pub const fn most(channels: usize) -> usize {
        fitting::<crate::message::Tick>(<Self as Wire>::FIXED_LEN, channels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::List;

    #[test]
    fn records_in_place_are_the_records() {
        let mut batch = Batch::new();
        for (step_us, bits, steps) in [(7, 0, &[1, -2, i16::MIN][..]), (u16::MAX, 0xA5, &[i16::MAX])] {
            let steps = List::from_slice(steps).unwrap();
            batch.push(&KnotStep { step_us, outputs: Outputs::from_bits(bits), steps }).unwrap();
        }
        let copied = |step: StepInPlace<'_>| {
            let steps = List::try_from_iter(step.steps()).unwrap();
            KnotStep { step_us: step.step_us, outputs: step.outputs, steps }
        };
        assert!(batch.in_place().map(copied).eq(batch.iter()));
        assert_eq!(batch.in_place().count(), 2);
    }
}
