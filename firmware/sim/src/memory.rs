//! Flash for the log, as an array: it loses nothing while the device is crashed or off.

use softlimb_firmware::log::{BLANK, LogMemory};

/// Words of a sector: an eighth of a chip's.
const WORDS: usize = 4096;

/// Two sectors, as delivered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ArrayMemory([Vec<u32>; 2]);

impl ArrayMemory {
    pub(crate) fn new() -> Self {
        Self([vec![BLANK; WORDS], vec![BLANK; WORDS]])
    }
}

impl LogMemory for ArrayMemory {
    fn words(&self) -> usize {
        WORDS
    }

    fn read(&self, sector: usize, index: usize) -> u32 {
        self.0.get(sector).and_then(|words| words.get(index)).copied().unwrap_or(BLANK)
    }

    fn program(&mut self, sector: usize, index: usize, word: u32) {
        if let Some(place) = self.0.get_mut(sector).and_then(|words| words.get_mut(index)) {
            *place &= word;
        }
    }

    fn erase(&mut self, sector: usize) {
        if let Some(words) = self.0.get_mut(sector) {
            words.fill(BLANK);
        }
    }
}
