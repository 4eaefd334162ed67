//! A record of the log as words.

use softlimb_protocol::{Code, LogKind, LogRecord, SYSTEM_CHANNEL, crc32c};

use super::memory::{BLANK, LogMemory};
use crate::controller::BootInfo;
use crate::faults::Occurrence;

/// Words of a record: number; start; kind, code and channel; detail; time, two words; CRC-32C of the words before.
pub(super) const WORDS: usize = 7;

/// Kind of the record at the beginning of a sector, which no host sees.
const BEGIN: u8 = 0;

/// Content of a record, without its number and its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    kind: u8,
    code: u8,
    channel: u8,
    detail: u32,
    time_us: u64,
}

impl Entry {
    /// The beginning of a sector.
    pub(super) const BEGIN: Self = Self { kind: BEGIN, code: 0, channel: SYSTEM_CHANNEL, detail: 0, time_us: 0 };

    /// A start of the device.
    pub(super) fn boot(boot: BootInfo) -> Self {
        let (kind, code) = (LogKind::Boot as u8, boot.cause as u8);
        Self { kind, code, channel: SYSTEM_CHANNEL, detail: boot.detail, time_us: 0 }
    }

    /// A fault.
    pub(super) fn fault(fault: &Occurrence) -> Self {
        let (kind, code) = (LogKind::Fault as u8, fault.code as u8);
        Self { kind, code, channel: fault.channel, detail: fault.value as u32, time_us: fault.time_us }
    }

    /// The words of the record with this number and start.
    pub(super) fn words(self, number: u32, start: u32) -> [u32; WORDS] {
        let kind = u32::from_le_bytes([self.kind, self.code, self.channel, 0]);
        let (low, high) = (self.time_us as u32, (self.time_us >> 32) as u32);
        let words = [number, start, kind, self.detail, low, high];
        [number, start, kind, self.detail, low, high, check(&words)]
    }
}

/// A record that was stored whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stored {
    number: u32,
    /// Number of the start of the device.
    pub(super) start: u32,
    entry: Entry,
}

impl Stored {
    /// The record as a host gets it; `None` for the beginning of a sector.
    pub(super) fn message(self) -> Option<LogRecord> {
        let Self { number, start, entry: Entry { kind, code, channel, detail, time_us } } = self;
        (kind != BEGIN).then(|| LogRecord { number, start, kind: Code::from_raw(kind), code, channel, detail, time_us })
    }
}

fn check(words: &[u32; WORDS - 1]) -> u32 {
    let mut bytes = [0; 4 * (WORDS - 1)];
    for (place, byte) in bytes.iter_mut().zip(words.iter().flat_map(|word| word.to_le_bytes())) {
        *place = byte;
    }
    crc32c(&bytes)
}

/// Places for records in a sector.
pub(super) fn slots(memory: &(impl LogMemory + ?Sized)) -> usize {
    memory.words() / WORDS
}

/// The words in a place.
pub(super) fn read(memory: &(impl LogMemory + ?Sized), sector: usize, slot: usize) -> [u32; WORDS] {
    core::array::from_fn(|word| memory.read(sector, slot * WORDS + word))
}

/// The record in a place; `None` for other words, such as a loss of power leaves.
pub(super) fn stored(memory: &(impl LogMemory + ?Sized), sector: usize, slot: usize) -> Option<Stored> {
    let [number, start, kind_code_channel, detail, low, high, sum] = read(memory, sector, slot);
    if sum != check(&[number, start, kind_code_channel, detail, low, high]) {
        return None;
    }
    let [kind, code, channel, _] = kind_code_channel.to_le_bytes();
    let time_us = u64::from(high) << 32 | u64::from(low);
    Some(Stored { number, start, entry: Entry { kind, code, channel, detail, time_us } })
}

/// Number of the record at the beginning of a sector, if there is one.
pub(super) fn begin(memory: &(impl LogMemory + ?Sized), sector: usize) -> Option<u32> {
    stored(memory, sector, 0).filter(|record| record.entry == Entry::BEGIN).map(|record| record.number)
}

/// The first place of a sector in which nothing was ever written. Places are used in order, so that halving finds it.
pub(super) fn end(memory: &(impl LogMemory + ?Sized), sector: usize) -> usize {
    let (mut low, mut high) = (1, slots(memory));
    while low < high {
        let middle = low + (high - low) / 2;
        if read(memory, sector, middle) == [BLANK; WORDS] { high = middle } else { low = middle + 1 }
    }
    low
}

/// Number of the last start in a sector whose places from `end` on are blank; 0 if no record is there.
pub(super) fn last_start(memory: &(impl LogMemory + ?Sized), sector: usize, end: usize) -> u32 {
    (0..end).rev().find_map(|slot| stored(memory, sector, slot)).map_or(0, |record| record.start)
}
