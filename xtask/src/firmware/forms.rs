//! An image as the bytes of the chip's memory, and as Intel's hexadecimal text.

use crate::elf::{self, Segment};

/// The chip's memory for programs begins here.
const FLASH: usize = 0x0800_0000;
const FLASH_BYTES: usize = 0x0010_0000;

/// Memory that is not written reads like this.
const ERASED: u8 = 0xff;

/// Bytes in a line of the text.
const LINE: usize = 16;

/// Content of the memory for programs, from an address on.
pub(super) struct Binary {
    pub(super) start: usize,
    pub(super) bytes: Vec<u8>,
}

/// The memory for programs once the image is in it.
///
/// # Errors
/// The file is none that the chip could hold.
pub(super) fn binary(file: &[u8]) -> Result<Binary, String> {
    let segments = elf::segments(file)?;
    let loaded = |segment: &&Segment<'_>| !segment.bytes.is_empty();
    let mut bytes = Vec::new();
    for segment in segments.iter().filter(loaded) {
        let at = segment.load_address.checked_sub(FLASH).filter(|at| at + segment.bytes.len() <= FLASH_BYTES);
        let at = at.ok_or_else(|| format!("a segment lies at {:#x}, outside the chip", segment.load_address))?;
        if bytes.len() < at + segment.bytes.len() {
            bytes.resize(at + segment.bytes.len(), ERASED);
        }
        bytes[at..at + segment.bytes.len()].copy_from_slice(segment.bytes);
    }
    if bytes.is_empty() { Err("nothing of it is to be loaded".to_owned()) } else { Ok(Binary { start: FLASH, bytes }) }
}

/// The text: records of type 4 for the upper half of an address, 0 for bytes, 1 for the end.
pub(super) fn hex(binary: &Binary) -> String {
    let mut text = String::new();
    let mut upper = None;
    for (index, line) in binary.bytes.chunks(LINE).enumerate() {
        let address = binary.start + LINE * index;
        if upper != Some(address >> 16) {
            upper = Some(address >> 16);
            text += &record(0, 4, &[(address >> 24) as u8, (address >> 16) as u8]);
        }
        text += &record(address as u16, 0, line);
    }
    text + &record(0, 1, &[])
}

fn record(address: u16, kind: u8, data: &[u8]) -> String {
    let [high, low] = address.to_be_bytes();
    let mut bytes = vec![data.len() as u8, high, low, kind];
    bytes.extend(data);
    let sum = bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    bytes.push(sum.wrapping_neg());
    let digits: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    format!(":{digits}\n")
}

/// A number that names the bytes: Fowler, Noll, Vo, 64 bits, variant 1a.
pub(super) fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_is_that_of_the_format_s_description() {
        // The example of Intel's "Hexadecimal Object File Format Specification": a record at 0x0100.
        let data = [0x21, 0x46, 0x01, 0x36, 0x01, 0x21, 0x47, 0x01, 0x36, 0x00, 0x7e, 0xfe, 0x09, 0xd2, 0x19, 0x01];
        assert_eq!(record(0x0100, 0, &data), ":10010000214601360121470136007EFE09D2190140\n");
        let text = hex(&Binary { start: 0x0800_fff0, bytes: vec![0; 17] });
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 5);
        assert_eq!((lines[0], lines[2], lines[4]), (":020000040800F2", ":020000040801F1", ":00000001FF"));
        assert!(lines[1].starts_with(":10FFF000") && lines[3].starts_with(":01000000"));
    }

    #[test]
    fn the_hash_is_the_published_one() {
        // Check values of draft-eastlake-fnv: of nothing, and of "foobar".
        assert_eq!((hash(b""), hash(b"foobar")), (0xcbf2_9ce4_8422_2325, 0x8594_4171_f739_67e8));
    }
}
