//! The seal of the flashed image: its length and checksums, by which the device knows at each start that it runs what was built.

use super::forms;
use crate::elf;

/// Name of its three words in the image: length, CRC-32C of what lies before them, and of what lies behind.
const NAME: &str = "IMAGE_SEAL";
const LEN: usize = 12;

/// Writes the seal into an image.
///
/// # Errors
/// The file is none that the chip could hold, has no place for a seal, or has gaps, which tools fill in different ways.
pub(super) fn seal(file: &mut [u8]) -> Result<(), String> {
    let forms::Binary { start, bytes } = forms::binary(file)?;
    let segments = elf::segments(file)?;
    let held: usize = segments.iter().map(|segment| segment.bytes.len()).sum();
    if held != bytes.len() {
        return Err(format!("{} bytes of the image lie in gaps of its segments", bytes.len().abs_diff(held)));
    }
    let address = elf::value(file, NAME)?.ok_or_else(|| format!("it has no `{NAME}`"))?;
    let at = address.checked_sub(start).filter(|at| at + LEN <= bytes.len());
    let at = at.ok_or_else(|| format!("`{NAME}` lies at {address:#x}, outside the image"))?;
    let holds = |segment: &&elf::Segment<'_>| {
        (segment.load_address..segment.load_address + segment.bytes.len()).contains(&address)
    };
    let segment = segments.iter().find(holds).ok_or_else(|| format!("`{NAME}` lies in no segment"))?;
    let place = segment.start + (address - segment.load_address);
    let length = u32::try_from(bytes.len()).map_err(|error| error.to_string())?;
    let words = [length, crc32c(&bytes[..at]), crc32c(&bytes[at + LEN..])].map(u32::to_le_bytes).concat();
    let target = file.get_mut(place..place + LEN).ok_or_else(|| format!("`{NAME}` lies outside the file"))?;
    target.copy_from_slice(&words);
    Ok(())
}

/// CRC-32C bit by bit: polynomial 1EDC6F41, reflected, initial value and final xor FFFFFFFF.
fn crc32c(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0x82f6_3b78 } else { crc >> 1 })
    })
}

#[cfg(test)]
mod tests {
    use super::crc32c;

    #[test]
    fn checksum_is_the_published_one() {
        // Catalogue check value, and RFC 3720 appendix B.4: 32 bytes of zeros.
        assert_eq!((crc32c(b"123456789"), crc32c(&[0; 32])), (0xe306_9283, 0x8a91_36aa));
    }
}
