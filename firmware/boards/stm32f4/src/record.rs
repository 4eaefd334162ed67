//! Record kept over a reset: the reason why the program stopped. Four words in memory that the start-up leaves alone.

use softlimb_firmware::BootInfo;
use softlimb_protocol::BootCause;

/// First word of a record, then of none.
const MAGIC: u32 = 0x5057_4d4c;

/// Why the program stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crash {
    /// The program found itself in a state that it cannot be in, in this line of its source.
    Panic {
        /// Line, from 1; 0 where it is not known.
        line: u32,
    },
    /// The processor met an instruction or address that it cannot serve.
    HardFault {
        /// Address of the instruction; 0 where it is not known, as after an overflow of the stack.
        address: u32,
    },
    /// The external clock stopped.
    ClockFailed,
}

impl Crash {
    /// The words to be kept.
    #[must_use]
    pub const fn to_words(self) -> [u32; 4] {
        let (kind, detail) = match self {
            Self::Panic { line } => (1, line),
            Self::HardFault { address } => (2, address),
            Self::ClockFailed => (3, 0),
        };
        [MAGIC, kind, detail, check(kind, detail)]
    }

    /// The crash that the words tell of; `None` for what memory holds after power came on.
    #[must_use]
    pub const fn from_words(words: [u32; 4]) -> Option<Self> {
        let [magic, kind, detail, sum] = words;
        if magic != MAGIC || sum != check(kind, detail) {
            return None;
        }
        match kind {
            1 => Some(Self::Panic { line: detail }),
            2 => Some(Self::HardFault { address: detail }),
            3 => Some(Self::ClockFailed),
            _ => None,
        }
    }
}

const fn check(kind: u32, detail: u32) -> u32 {
    !(MAGIC ^ kind.rotate_left(8) ^ detail.rotate_left(16))
}

/// Flags of the chip that say what reset it: bits of RCC_CSR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResetFlags(pub u32);

/// Why the device started: what it remembers of a crash, else what the chip says.
#[must_use]
pub fn boot_info(crash: Option<Crash>, flags: ResetFlags) -> BootInfo {
    let is = |bit: u32| flags.0 & 1 << bit != 0;
    let (cause, detail) = match crash {
        Some(Crash::Panic { line }) => (BootCause::Panic, line),
        Some(Crash::HardFault { address }) => (BootCause::HardFault, address),
        Some(Crash::ClockFailed) => (BootCause::ClockFailure, 0),
        // Reference manual RM0090, RCC_CSR. Power coming on sets the flag of brown-out too; every reset that of the pin.
        None if is(29) || is(30) => (BootCause::Watchdog, 0),
        None if is(28) => (BootCause::Software, 0),
        None if is(27) => (BootCause::PowerOn, 0),
        None if is(25) => (BootCause::BrownOut, 0),
        None if is(26) => (BootCause::ResetPin, 0),
        None => (BootCause::PowerOn, 0),
    };
    BootInfo { cause, detail }
}

/// Boot information of a device whose image is damaged. Such a device opens its vents and refuses to start.
pub const DAMAGED: BootInfo = BootInfo { cause: BootCause::ImageDamaged, detail: 0 };

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn record_survives_and_anything_else_is_none() {
        for crash in [
            Crash::Panic { line: 17 },
            Crash::HardFault { address: 0x0800_1234 },
            Crash::HardFault { address: 0 },
            Crash::ClockFailed,
        ] {
            let words = crash.to_words();
            assert_eq!(Crash::from_words(words), Some(crash));
            for bit in 0..128 {
                let mut hurt = words;
                hurt[bit / 32] ^= 1 << (bit % 32);
                assert_eq!(Crash::from_words(hurt), None, "bit {bit}");
            }
        }
        assert_eq!(Crash::from_words([0; 4]), None);
        assert_eq!(Crash::from_words([u32::MAX; 4]), None);
    }

    #[test]
    fn remembered_crash_counts_more_than_the_flags() {
        let cause = |crash, bits: &[u32]| boot_info(crash, ResetFlags(bits.iter().map(|bit| 1 << bit).sum())).cause;
        assert_eq!(cause(Some(Crash::Panic { line: 1 }), &[28, 26]), BootCause::Panic);
        assert_eq!(cause(Some(Crash::ClockFailed), &[28, 26]), BootCause::ClockFailure);
        assert_eq!(cause(None, &[28, 26]), BootCause::Software);
        assert_eq!(cause(None, &[29, 26]), BootCause::Watchdog);
        assert_eq!(cause(None, &[27, 26, 25]), BootCause::PowerOn);
        assert_eq!(cause(None, &[26, 25]), BootCause::BrownOut);
        assert_eq!(cause(None, &[26]), BootCause::ResetPin);
        assert_eq!(cause(None, &[]), BootCause::PowerOn);
        assert_eq!(boot_info(Some(Crash::HardFault { address: 5 }), ResetFlags(0)).detail, 5);
    }
}
