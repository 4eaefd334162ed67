//! The sectors of flash that hold the log.
//!
//! While a word is programmed or a sector erased, the processor stalls at its next fetch from flash.

use core::ptr::{read_volatile, write_volatile};

use softlimb_firmware::log::{BLANK, LogMemory};
use stm32f4xx_hal::pac::FLASH;

use crate::log_sectors::{CLEAR, KEYS, LOCK, PROGRAM, SECTOR_BYTES, SECTORS, START, erase};

/// Reads of the status of a busy unit: seconds. Erasing takes two.
const LOOKS: u32 = 10_000_000;

/// Both sectors. The caches of the flash unit are off until the clocks start: erase before.
pub struct LogFlash(FLASH);

impl LogFlash {
    /// Takes the flash unit.
    #[must_use]
    pub const fn new(flash: FLASH) -> Self {
        Self(flash)
    }

    fn is_idle(&self) -> bool {
        (0..LOOKS).any(|_| self.0.sr().read().bsy().bit_is_clear())
    }

    /// Runs an operation with the unit unlocked, and waits for its end.
    fn unlocked(&self, act: impl FnOnce(&FLASH)) {
        if !self.is_idle() {
            return;
        }
        // SAFETY: the order and the values are those of RM0090, "Unlocking the flash control register" and "Erase and program operations".
        unsafe {
            for key in KEYS {
                self.0.keyr().write(|w| w.bits(key));
            }
            self.0.sr().write(|w| w.bits(CLEAR));
            act(&self.0);
            let _ = self.is_idle();
            self.0.cr().write(|w| w.bits(LOCK));
        }
    }
}

/// Address of a word of the log.
fn address(sector: usize, index: usize) -> Option<*mut u32> {
    let &(start, _) = SECTORS.get(sector)?;
    (index < SECTOR_BYTES / 4).then_some((start + 4 * index) as *mut u32)
}

impl LogMemory for LogFlash {
    fn words(&self) -> usize {
        SECTOR_BYTES / 4
    }

    fn read(&self, sector: usize, index: usize) -> u32 {
        // SAFETY: the address is one of the log's, in flash. Volatile, because the words change.
        address(sector, index).map_or(BLANK, |word| unsafe { read_volatile(word) })
    }

    fn program(&mut self, sector: usize, index: usize, word: u32) {
        let Some(place) = address(sector, index) else { return };
        // SAFETY: the unit takes a write of one word to the log's flash, which no reference points to.
        self.unlocked(|flash| unsafe {
            flash.cr().write(|w| w.bits(PROGRAM));
            write_volatile(place, word);
        });
    }

    fn erase(&mut self, sector: usize) {
        let Some(&(_, number)) = SECTORS.get(sector) else { return };
        // SAFETY: the sector is one of the log's: no image and no reference reaches it.
        self.unlocked(|flash| unsafe {
            flash.cr().write(|w| w.bits(erase(number)));
            flash.cr().write(|w| w.bits(erase(number) | START));
        });
    }
}
