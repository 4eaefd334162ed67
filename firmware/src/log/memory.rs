//! Memory of the log: what a flash with two sectors can do.

/// An erased word.
pub const BLANK: u32 = u32::MAX;

/// Two sectors of flash. Words are read at any time, programmed one by one, and erased with their whole sector.
pub trait LogMemory {
    /// Words of each sector.
    fn words(&self) -> usize;

    /// Word `index` of a sector, 0 or 1; [`BLANK`] if there is no such word.
    fn read(&self, sector: usize, index: usize) -> u32;

    /// Programs one word: bits go from 1 to 0. The processor may stall meanwhile, for up to 100 us. The caller reads the word back.
    fn program(&mut self, sector: usize, index: usize, word: u32);

    /// Makes all words of a sector [`BLANK`]. The processor may stall meanwhile, for seconds. The caller reads the words back.
    fn erase(&mut self, sector: usize);
}
