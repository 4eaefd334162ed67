//! The log of starts and faults, which outlasts a reset and a loss of power.
//!
//! Two sectors of flash are used in turn. Each begins with a record of its own; record k behind it has the number of the first one plus k.
//! A place that a loss of power has left half written keeps its number and is passed over. A sector is erased at a start of the device
//! alone ([`prepare`]), and never the newer one. While the device runs, at most one word a turn is programmed, and none while the limb
//! follows setpoints.

mod memory;
mod record;
#[cfg(test)]
mod tests;

use heapless::Deque;
use softlimb_protocol::{Batch, DeviceState, FaultCode, LogCondition, LogRecord, LogState};

pub use memory::{BLANK, LogMemory};

use crate::board::Board;
use crate::controller::{BootInfo, Controller};
use crate::faults::Occurrence;
use record::{Entry, WORDS, begin, end, last_start, read, slots, stored};

/// Records that can wait.
const WAITING: usize = 16;

/// Places read for one answer, which bounds its time: those that a loss of power has spoiled hold nothing to be sent.
const PLACES_MAX: u32 = 32;

/// The sector that the next record goes to, 0 or 1, and the number of its first record.
fn newest(memory: &(impl LogMemory + ?Sized)) -> Option<(usize, u32)> {
    match (begin(memory, 0), begin(memory, 1)) {
        (Some(first), Some(second)) => Some(if first > second { (0, first) } else { (1, second) }),
        (first, second) => first.map(|number| (0, number)).or(second.map(|number| (1, number))),
    }
}

/// Whether [`prepare`] would erase: less than a quarter of the newer sector is left.
#[must_use]
pub fn wants_room(memory: &(impl LogMemory + ?Sized)) -> bool {
    let slots = slots(memory);
    newest(memory).is_none_or(|(sector, _)| 4 * (slots - end(memory, sector)) < slots)
}

/// Erases the older sector if the newer one has little room. Call it before the watchdog runs and while no coil has current: it takes seconds.
/// A loss of power on the way leaves the newer sector as it was.
pub fn prepare(memory: &mut (impl LogMemory + ?Sized)) {
    if !wants_room(memory) {
        return;
    }
    let (sector, number, start) = match newest(memory) {
        Some((newer, first)) => {
            let start = last_start(memory, newer, end(memory, newer));
            (1 - newer, first.saturating_add(slots(memory) as u32), start)
        }
        None => (0, 1, 0),
    };
    // A sector that is half erased must not look like a whole one.
    if begin(memory, sector).is_some() {
        memory.program(sector, 0, 0);
    }
    memory.erase(sector);
    if (0..memory.words()).all(|word| memory.read(sector, word) == BLANK) {
        for (word, value) in Entry::BEGIN.words(number, start).into_iter().enumerate() {
            memory.program(sector, word, value);
        }
    }
}

/// The log while the device runs: the end of what its memory holds, and the records that wait. A board owns both.
#[derive(Clone, Debug)]
pub struct Log {
    condition: LogCondition,
    /// The newer sector, the number of its first record, and the place of the next one.
    sector: usize,
    begin: u32,
    slot: usize,
    /// Number of the first record that can be there; in the other sector if it is less than `begin`.
    oldest: u32,
    /// Number of this start of the device.
    start: u32,
    waiting: Deque<Entry, WAITING>,
    /// Words of the first waiting record that are programmed.
    programmed: usize,
    unstored: u32,
}

impl Log {
    /// The log before the first turn.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            condition: LogCondition::Absent,
            sector: 0,
            begin: 0,
            slot: 0,
            oldest: 0,
            start: 0,
            waiting: Deque::new(),
            programmed: 0,
            unstored: 0,
        }
    }

    /// Finds the end of the log and notes a start of the device.
    fn open(&mut self, memory: &dyn LogMemory, boot: BootInfo) {
        *self = Self { condition: LogCondition::Failed, ..Self::new() };
        if let Some((sector, begin_number)) = newest(memory) {
            let (slot, slots) = (end(memory, sector), slots(memory));
            (self.sector, self.begin, self.slot) = (sector, begin_number, slot);
            self.oldest = begin(memory, 1 - sector)
                .filter(|&older| older.saturating_add(slots as u32) == begin_number)
                .unwrap_or(begin_number);
            self.start = last_start(memory, sector, slot).saturating_add(1);
            self.condition = if slot < slots { LogCondition::Kept } else { LogCondition::Full };
        }
        self.note(Entry::boot(boot));
    }

    /// Takes a record; later turns store it.
    fn note(&mut self, entry: Entry) {
        if self.condition != LogCondition::Kept || self.waiting.push_back(entry).is_err() {
            self.unstored = self.unstored.saturating_add(1);
        }
    }

    /// Programs one word, if one is waiting.
    fn work(&mut self, memory: &mut dyn LogMemory) {
        let Some(waiting) = self.waiting.front() else { return };
        let words = waiting.words(self.next(), self.start);
        let Some(word) = words.get(self.programmed) else { return };
        memory.program(self.sector, self.slot * WORDS + self.programmed, *word);
        self.programmed += 1;
        if self.programmed < WORDS {
            return;
        }
        self.programmed = 0;
        if read(memory, self.sector, self.slot) != words {
            self.stop(LogCondition::Failed);
            return;
        }
        self.waiting.pop_front();
        self.slot += 1;
        if self.slot >= slots(memory) {
            self.stop(LogCondition::Full);
        }
    }

    /// Stores nothing more until the next start.
    fn stop(&mut self, condition: LogCondition) {
        self.condition = condition;
        self.unstored = self.unstored.saturating_add(self.waiting.len() as u32);
        self.waiting.clear();
    }

    /// Number of the next record.
    fn next(&self) -> u32 {
        self.begin.saturating_add(self.slot as u32)
    }

    fn record(&self, memory: &dyn LogMemory, number: u32) -> Option<LogRecord> {
        let (sector, first) =
            if number < self.begin { (1 - self.sector, self.oldest) } else { (self.sector, self.begin) };
        stored(memory, sector, number.checked_sub(first)? as usize)?.message().filter(|record| record.number == number)
    }

    /// Records from a number on, as many as one message holds, and the state of the log.
    fn page(&self, memory: &dyn LogMemory, first: u32) -> (LogState, Batch<LogRecord>) {
        let mut records = Batch::new();
        let next = self.next();
        let mut until = first.clamp(self.oldest, next);
        let last = until.saturating_add(PLACES_MAX).min(next);
        while until < last && self.record(memory, until).is_none_or(|record| records.push(&record).is_ok()) {
            until += 1;
        }
        let (condition, unstored, sent) = (self.condition.into(), self.unstored, records.len() as u8);
        (LogState { condition, unstored, next, until, records: sent }, records)
    }
}

impl Default for Log {
    fn default() -> Self {
        Self::new()
    }
}

/// Notes a start of the device in the first tick, and the faults of the present one. The end of the setpoints is the end of a run and not noted.
#[inline(never)]
pub(crate) fn note<'a, const N: usize, B: Board<N> + ?Sized>(
    board: &mut B,
    boot: Option<BootInfo>,
    faults: impl Iterator<Item = &'a Occurrence>,
) {
    let Some((log, memory)) = board.log() else { return };
    if let Some(boot) = boot {
        log.open(memory, boot);
    }
    for fault in faults.filter(|fault| fault.code != FaultCode::SetpointsExhausted) {
        log.note(Entry::fault(fault));
    }
}

/// Programs at most one word, and answers a request. A limb that follows setpoints does not wait for flash.
#[inline(never)]
pub(crate) fn keep<const N: usize, B: Board<N> + ?Sized>(controller: &mut Controller<N>, board: &mut B) {
    if controller.state() == DeviceState::Running {
        return;
    }
    let log = board.log();
    let first = controller.log_request.take();
    let Some((log, memory)) = log else {
        if first.is_some() {
            controller.send_log(LogState::ABSENT, Batch::new());
        }
        return;
    };
    log.work(memory);
    if let Some(first) = first {
        let (state, records) = log.page(memory, first.get());
        controller.send_log(state, records);
    }
}
