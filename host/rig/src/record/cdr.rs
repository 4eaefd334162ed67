//! CDR, little-endian, as ROS 2 writes it (OMG DDS-XTypes 7.4.1, "XCDR1").
//!
//! A message begins with the four bytes 00 01 00 00. Every number is aligned to its
//! own size, counted from the byte after those four. A string is its length with the
//! closing zero as u32, the bytes, the zero. A sequence is its count as u32, then
//! the elements; an array is the elements alone.

/// Representation identifier: plain CDR, little-endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Room that a message has from its start, bytes: a small one is allocated once.
const MESSAGE: usize = 1 << 10;

/// Why a message does not decode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// The first four bytes name another representation.
    #[error("not little-endian CDR")]
    Encapsulation,
    /// The message ends inside a value.
    #[error("message ends inside the value at byte {at}")]
    Short {
        /// Offset from the start of the body, bytes.
        at: usize,
    },
    /// A string is not UTF-8 or has no closing zero.
    #[error("bad string at byte {at}")]
    Text {
        /// Offset from the start of the body, bytes.
        at: usize,
    },
}

/// Builds one message.
#[derive(Debug)]
pub(super) struct CdrWriter {
    bytes: Vec<u8>,
}

impl CdrWriter {
    /// An empty message.
    pub(super) fn new() -> Self {
        let mut bytes = Vec::with_capacity(MESSAGE);
        bytes.extend_from_slice(&ENCAPSULATION);
        Self { bytes }
    }

    /// The finished message.
    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Appends zeros up to a multiple of a size.
    fn align(&mut self, size: usize) {
        let body = self.bytes.len() - ENCAPSULATION.len();
        self.bytes.resize(body.next_multiple_of(size) + ENCAPSULATION.len(), 0);
    }

    /// Appends numbers of one size, which need no count.
    fn numbers<const N: usize>(&mut self, numbers: impl ExactSizeIterator<Item = [u8; N]>) {
        if numbers.len() == 0 {
            return;
        }
        self.align(N);
        let start = self.bytes.len();
        self.bytes.resize(start + N * numbers.len(), 0);
        let (places, _) = self.bytes[start..].as_chunks_mut::<N>();
        places.iter_mut().zip(numbers).for_each(|(place, number)| *place = number);
    }

    fn number<const N: usize>(&mut self, le_bytes: [u8; N]) {
        self.numbers([le_bytes].into_iter());
    }

    /// Appends a `uint8`.
    pub(super) fn u8(&mut self, value: u8) {
        self.number(value.to_le_bytes());
    }

    /// Appends a `uint16`.
    pub(super) fn u16(&mut self, value: u16) {
        self.number(value.to_le_bytes());
    }

    /// Appends a `uint32`.
    pub(super) fn u32(&mut self, value: u32) {
        self.number(value.to_le_bytes());
    }

    /// Appends a `uint64`.
    pub(super) fn u64(&mut self, value: u64) {
        self.number(value.to_le_bytes());
    }

    /// Appends an `int32`.
    pub(super) fn i32(&mut self, value: i32) {
        self.number(value.to_le_bytes());
    }

    /// Appends a `float32`.
    pub(super) fn f32(&mut self, value: f32) {
        self.number(value.to_le_bytes());
    }

    /// Appends a `float64`.
    pub(super) fn f64(&mut self, value: f64) {
        self.number(value.to_le_bytes());
    }

    /// Appends a `string`.
    pub(super) fn string(&mut self, text: &str) {
        self.length(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    /// Appends the count of a sequence; the elements follow.
    pub(super) fn length(&mut self, count: usize) {
        // A message of 4 GiB cannot arise from 27 channels; saturating keeps it defined.
        self.u32(u32::try_from(count).unwrap_or(u32::MAX));
    }

    /// Appends a `float64[]`.
    pub(super) fn f64_sequence(&mut self, values: impl ExactSizeIterator<Item = f64>) {
        self.length(values.len());
        self.numbers(values.map(f64::to_le_bytes));
    }

    /// Appends a `uint8[]`.
    pub(super) fn u8_sequence(&mut self, values: &[u8]) {
        self.length(values.len());
        self.bytes.extend_from_slice(values);
    }

    /// Appends a `uint16[]`.
    pub(super) fn u16_sequence(&mut self, values: impl ExactSizeIterator<Item = u16>) {
        self.length(values.len());
        self.numbers(values.map(u16::to_le_bytes));
    }

    /// Appends a `geometry_msgs/Point`.
    pub(super) fn point(&mut self, point: [f64; 3]) {
        self.numbers(point.map(f64::to_le_bytes).into_iter());
    }
}

/// Takes one message apart.
#[derive(Debug)]
pub(super) struct CdrReader<'a> {
    body: &'a [u8],
    at: usize,
}

impl<'a> CdrReader<'a> {
    /// A reader over a whole message.
    ///
    /// # Errors
    /// [`CdrError::Encapsulation`] for any other representation.
    pub(super) fn new(message: &'a [u8]) -> Result<Self, CdrError> {
        let body = message.strip_prefix(&ENCAPSULATION).ok_or(CdrError::Encapsulation)?;
        Ok(Self { body, at: 0 })
    }

    fn bytes(&mut self, count: usize) -> Result<&'a [u8], CdrError> {
        let short = CdrError::Short { at: self.at };
        let end = self.at.checked_add(count).ok_or(short)?;
        let bytes = self.body.get(self.at..end).ok_or(short)?;
        self.at = end;
        Ok(bytes)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        self.at = self.at.next_multiple_of(N);
        let at = self.at;
        self.bytes(N)?.try_into().map_err(|_| CdrError::Short { at })
    }

    /// Takes a `uint8`.
    pub(super) fn u8(&mut self) -> Result<u8, CdrError> {
        self.number().map(u8::from_le_bytes)
    }

    /// Takes a `uint16`.
    pub(super) fn u16(&mut self) -> Result<u16, CdrError> {
        self.number().map(u16::from_le_bytes)
    }

    /// Takes a `uint32`.
    pub(super) fn u32(&mut self) -> Result<u32, CdrError> {
        self.number().map(u32::from_le_bytes)
    }

    /// Takes a `uint64`.
    pub(super) fn u64(&mut self) -> Result<u64, CdrError> {
        self.number().map(u64::from_le_bytes)
    }

    /// Takes an `int32`.
    pub(super) fn i32(&mut self) -> Result<i32, CdrError> {
        self.number().map(i32::from_le_bytes)
    }

    /// Takes a `float64`.
    pub(super) fn f64(&mut self) -> Result<f64, CdrError> {
        self.number().map(f64::from_le_bytes)
    }

    /// Takes a `string`.
    pub(super) fn string(&mut self) -> Result<String, CdrError> {
        let count = self.u32()? as usize;
        let bad = CdrError::Text { at: self.at };
        let text = self.bytes(count)?.strip_suffix(&[0]).ok_or(bad)?;
        String::from_utf8(text.to_vec()).map_err(|_| bad)
    }

    /// Takes a sequence whose elements `element` takes.
    pub(super) fn sequence<T>(
        &mut self,
        mut element: impl FnMut(&mut Self) -> Result<T, CdrError>,
    ) -> Result<Vec<T>, CdrError> {
        let count = self.u32()?;
        // No capacity from the count: a damaged one must not reserve gigabytes.
        let mut elements = Vec::new();
        for _ in 0..count {
            elements.push(element(self)?);
        }
        Ok(elements)
    }

    /// Takes a `uint8[]`.
    pub(super) fn u8_sequence(&mut self) -> Result<Vec<u8>, CdrError> {
        let count = self.u32()? as usize;
        self.bytes(count).map(<[u8]>::to_vec)
    }

    /// Takes a `geometry_msgs/Point`.
    pub(super) fn point(&mut self) -> Result<[f64; 3], CdrError> {
        Ok([self.f64()?, self.f64()?, self.f64()?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Laid out by hand from the alignment rule.
    const BY_HAND: [u8; 44] = [
        0, 1, 0, 0, // little-endian CDR
        7, 0, // u8 at 0, padding to 2
        0x34, 0x12, // u16 0x1234 at 2
        3, 0, 0, 0, b'h', b'i', 0, // string at 4: length 3 with its zero
        0, // padding to 12
        0xfe, 0xff, 0xff, 0xff, // i32 -2 at 12
        2, 0, 0, 0, // float64[] at 16: two elements
        0, 0, 0, 0, // padding to 24
        0, 0, 0, 0, 0, 0, 0xf8, 0x3f, // 1.5 at 24
        0, 0, 0, 0, 0, 0, 0x00, 0xc0, // -2.0 at 32
    ];

    #[test]
    fn bytes_are_written_as_laid_out_by_hand() {
        let mut writer = CdrWriter::new();
        writer.u8(7);
        writer.u16(0x1234);
        writer.string("hi");
        writer.i32(-2);
        writer.f64_sequence([1.5, -2.0].into_iter());
        assert_eq!(writer.into_bytes(), BY_HAND);
    }

    #[test]
    fn bytes_laid_out_by_hand_are_read() {
        let mut reader = CdrReader::new(&BY_HAND).unwrap();
        assert_eq!(reader.u8(), Ok(7));
        assert_eq!(reader.u16(), Ok(0x1234));
        assert_eq!(reader.string().as_deref(), Ok("hi"));
        assert_eq!(reader.i32(), Ok(-2));
        assert_eq!(reader.sequence(CdrReader::f64), Ok(vec![1.5, -2.0]));
        assert_eq!(reader.u8(), Err(CdrError::Short { at: 40 }));
    }

    #[test]
    fn big_endian_and_empty_input_are_refused() {
        assert_eq!(CdrReader::new(&[0, 0, 0, 0]).unwrap_err(), CdrError::Encapsulation);
        assert_eq!(CdrReader::new(&[]).unwrap_err(), CdrError::Encapsulation);
    }

    #[test]
    fn count_beyond_the_message_is_an_error_not_an_allocation() {
        let message = [0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff];
        let mut reader = CdrReader::new(&message).unwrap();
        assert_eq!(reader.sequence(CdrReader::f64), Err(CdrError::Short { at: 8 }));
        let mut reader = CdrReader::new(&message).unwrap();
        assert_eq!(reader.string(), Err(CdrError::Short { at: 4 }));
    }

    #[test]
    fn string_needs_its_closing_zero_and_utf8() {
        for text in [[b'h', b'i'], [0xff, 0]] {
            let mut message = vec![0, 1, 0, 0, 2, 0, 0, 0];
            message.extend(text);
            let mut reader = CdrReader::new(&message).unwrap();
            assert_eq!(reader.string(), Err(CdrError::Text { at: 4 }));
        }
    }
}
