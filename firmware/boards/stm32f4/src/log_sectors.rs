//! The two sectors of flash that hold the log, and the values of the registers that write them.

/// Bytes of a sector from the fifth on (RM0090 and RM0390, "Flash module organization").
pub const SECTOR_BYTES: usize = 128 * 1024;

/// Start of a sector, and its number: the last two that both chips have. The image lies in sectors before them.
pub const SECTORS: [(usize, u32); 2] = [(0x0804_0000, 6), (0x0806_0000, 7)];

/// Values of FLASH_KEYR that unlock FLASH_CR.
pub const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// FLASH_CR: 32 bits at once, which take 2.7 V at least.
const BY_WORD: u32 = 0b10 << 8;

/// FLASH_CR: words are programmed.
pub const PROGRAM: u32 = 1 | BY_WORD;

/// FLASH_CR: start.
pub const START: u32 = 1 << 16;

/// FLASH_CR: locked, until the keys come again.
pub const LOCK: u32 = 1 << 31;

/// FLASH_SR: end of an operation, and errors of one before. A 1 clears each, and they forbid programming until then.
pub const CLEAR: u32 = 0b1111_0011;

/// FLASH_CR: a sector is erased.
#[must_use]
pub const fn erase(number: u32) -> u32 {
    number << 3 | 1 << 1 | BY_WORD
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes of the sectors of either chip, KiB, from the start of flash.
    const SIZES: [usize; 8] = [16, 16, 16, 16, 64, 128, 128, 128];

    #[test]
    fn sectors_are_those_of_the_manual_and_no_image_reaches_them() {
        for (address, number) in SECTORS {
            let before: usize = SIZES[..number as usize].iter().sum();
            assert_eq!(address, 0x0800_0000 + 1024 * before);
            assert_eq!(1024 * SIZES[number as usize], SECTOR_BYTES);
            // The largest image that the build accepts.
            assert!(before >= 96);
        }
        let [first, second] = SECTORS;
        assert_eq!((first.0 + SECTOR_BYTES, second.0 + SECTOR_BYTES), (second.0, 0x0800_0000 + 512 * 1024));
        let linker = include_str!("../memory.x");
        assert!(linker.contains("FLASH : ORIGIN = 0x08000000, LENGTH = 256K"), "the linker leaves them alone");
    }

    #[test]
    fn registers_have_the_fields_of_the_manual() {
        for (_, number) in SECTORS {
            let field = |lowest: u32, bits: u32| erase(number) >> lowest & ((1 << bits) - 1);
            assert_eq!((field(0, 1), field(1, 1), field(2, 1)), (0, 1, 0), "PG, SER, MER");
            assert_eq!((field(3, 4), field(8, 2)), (number, 2), "SNB, PSIZE: 32 bits");
            assert_eq!(erase(number) >> 10, 0, "no start, no interrupt, no lock");
        }
        assert_eq!((PROGRAM & 0b111, PROGRAM >> 8), (1, 2), "PG alone, PSIZE: 32 bits");
    }
}
