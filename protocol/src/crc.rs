//! The one checksum of the link.

use crc::{CRC_32_ISCSI, Crc, Digest};

/// The table of CRC-32C: polynomial 1EDC6F41, reflected, initial value and final xor FFFFFFFF.
static CRC_32C: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// CRC-32C (Castagnoli, iSCSI) of `bytes`; check value of `"123456789"` is `E3069283`.
#[must_use]
pub fn crc32c(bytes: &[u8]) -> u32 {
    CRC_32C.checksum(bytes)
}

/// CRC-32C usable in constants.
pub(crate) const fn crc32c_const(bytes: &[u8]) -> u32 {
    Crc::<u32>::new(&CRC_32_ISCSI).checksum(bytes)
}

/// A CRC-32C in progress.
pub(crate) fn crc32c_digest(initial: u32) -> Digest<'static, u32> {
    CRC_32C.digest_with_initial(initial)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_check_values() {
        // Catalogue check value, and RFC 3720 appendix B.4: 32 bytes of zeros, of ones, ascending, descending.
        assert_eq!(crc32c(b"123456789"), 0xE306_9283);
        assert_eq!(crc32c(&[0; 32]), 0x8A91_36AA);
        assert_eq!(crc32c(&[0xFF; 32]), 0x62A8_AB43);
        let ascending: [u8; 32] = core::array::from_fn(|i| i as u8);
        assert_eq!(crc32c(&ascending), 0x46DD_794E);
        let descending: [u8; 32] = core::array::from_fn(|i| 31 - i as u8);
        assert_eq!(crc32c(&descending), 0x113F_DB5C);
    }

    #[test]
    fn constant_and_table_agree() {
        const HASH: u32 = crc32c_const(b"123456789");
        assert_eq!(HASH, 0xE306_9283);
    }
}
