//! The supply voltage below which the chip is held in reset: an option byte, which lasts.

/// Bits of FLASH_OPTCR (RM0090 and RM0390, "Flash option control register").
const LEVEL: u32 = 0b11 << 2;
const PROTECTION: u32 = 0xff << 8;

/// Reset below 2.7 V at least: less is too little for 168 MHz with the wait states that the clocks are set up with.
const LEVEL_3: u32 = 0b00 << 2;

/// Protection off. Another value is a decision of the board's owner, and a wrong write to it can lock a chip for good.
const UNPROTECTED: u32 = 0xaa << 8;

/// The lock and start bits, which are no option.
const CONTROL: u32 = 0b11;

/// What FLASH_OPTCR should hold in place of `now`, without its control bits; `None` where nothing is to be written.
#[must_use]
pub const fn wanted(now: u32) -> Option<u32> {
    if now & LEVEL == LEVEL_3 || now & PROTECTION != UNPROTECTED {
        return None;
    }
    Some(now & !LEVEL & !CONTROL | LEVEL_3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As chips are delivered: no level, no protection, all sectors writable, locked.
    const DELIVERED: u32 = 0x0fff_aaed;

    #[test]
    fn level_alone_changes_and_once_only() {
        let set = wanted(DELIVERED).expect("the level is to be set");
        assert_eq!(set, 0x0fff_aae0);
        assert_eq!(wanted(set | 1), None, "a second start writes nothing");
        for level in 1..4 {
            assert_eq!(wanted(0x0fff_aae1 | level << 2), Some(0x0fff_aae0));
        }
    }

    #[test]
    fn protected_chips_and_an_emulator_are_left_alone() {
        for protection in (0..=0xff).filter(|byte| *byte != 0xaa) {
            assert_eq!(wanted(DELIVERED & !PROTECTION | protection << 8), None, "{protection:#x}");
        }
        assert_eq!(wanted(0), None);
    }
}
