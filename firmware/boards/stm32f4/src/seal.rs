//! The seal of an image: its length and checksums, which `cargo xtask firmware` writes into it. An image without one counts as damaged.

use softlimb_protocol::crc32c;

/// Words of the seal: length of the image in bytes, CRC-32C of what lies before the seal, and of what lies behind it.
pub const WORDS: usize = 3;

/// Bytes of the seal.
pub const LEN: usize = 4 * WORDS;

/// The seal of an image that has none yet.
pub const NONE: [u32; WORDS] = [0; WORDS];

/// Whether the image, whose seal lies at `at`, is what its seal says.
#[must_use]
pub fn is_whole(image: &[u8], at: usize, seal: [u32; WORDS]) -> bool {
    let (before, behind) = (image.get(..at), at.checked_add(LEN).and_then(|end| image.get(end..)));
    let (Some(before), Some(behind)) = (before, behind) else { return false };
    let [length, crc_before, crc_behind] = seal;
    u32::try_from(image.len()) == Ok(length) && crc32c(before) == crc_before && crc32c(behind) == crc_behind
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: usize = 40;

    fn sealed() -> (Vec<u8>, [u32; WORDS]) {
        let image: Vec<u8> = (0..100_u8).map(|byte| byte.wrapping_mul(37)).collect();
        let seal = [100, crc32c(&image[..AT]), crc32c(&image[AT + LEN..])];
        (image, seal)
    }

    #[test]
    fn every_damaged_bit_is_noticed() {
        let (image, seal) = sealed();
        assert!(is_whole(&image, AT, seal));
        for bit in (0..8 * image.len()).filter(|bit| !(8 * AT..8 * (AT + LEN)).contains(bit)) {
            let mut hurt = image.clone();
            hurt[bit / 8] ^= 1 << (bit % 8);
            assert!(!is_whole(&hurt, AT, seal), "bit {bit}");
        }
        for bit in 0..32 * WORDS {
            let mut hurt = seal;
            hurt[bit / 32] ^= 1 << (bit % 32);
            assert!(!is_whole(&image, AT, hurt), "bit {bit} of the seal");
        }
    }

    #[test]
    fn image_without_a_seal_or_written_in_part_is_damaged() {
        let (image, seal) = sealed();
        assert!(!is_whole(&image, AT, NONE));
        assert!(!is_whole(&image, AT, [u32::MAX; WORDS]), "erased flash");
        for length in 0..image.len() {
            assert!(!is_whole(&image[..length], AT, seal), "{length} bytes");
            let mut part = image.clone();
            part[length..].fill(0xff);
            assert!(!is_whole(&part, AT, seal), "{length} bytes are written");
        }
    }
}
