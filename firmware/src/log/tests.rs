//! The log on a flash that loses power at every word and in every erasure.

use softlimb_protocol::{BootCause, FaultCode, LogKind};

use super::*;
use crate::faults::Occurrence;

const WORDS_OF_SECTOR: usize = 115;
/// They hold sixteen records, one of them the sector's own.
const KEPT_OF_SECTOR: usize = 15;

/// Flash whose power fails at a certain program or erase, which it leaves half done.
#[derive(Clone)]
struct Cells {
    words: [Vec<u32>; 2],
    /// Programs and erases that are left, and those done.
    power: usize,
    done: usize,
    erased: usize,
    seed: u32,
    /// It takes nothing, as the flash of an emulator.
    is_fixed: bool,
}

impl Cells {
    fn delivered() -> Self {
        let words = [vec![BLANK; WORDS_OF_SECTOR], vec![BLANK; WORDS_OF_SECTOR]];
        Self { words, power: usize::MAX, done: 0, erased: 0, seed: 1, is_fixed: false }
    }

    /// A shift register of 32 bits: taps 32, 22, 2, 1.
    fn random(&mut self) -> u32 {
        for _ in 0..32 {
            let bit = (self.seed >> 31 ^ self.seed >> 21 ^ self.seed >> 1 ^ self.seed) & 1;
            self.seed = self.seed << 1 | bit;
        }
        self.seed
    }

    /// Whether the next act is whole, half done, or not done.
    fn act(&mut self) -> Option<bool> {
        if self.power == 0 || self.is_fixed {
            return None;
        }
        self.power -= 1;
        self.done += 1;
        Some(self.power > 0)
    }

    fn is_off(&self) -> bool {
        self.power == 0
    }
}

impl LogMemory for Cells {
    fn words(&self) -> usize {
        WORDS_OF_SECTOR
    }

    fn read(&self, sector: usize, index: usize) -> u32 {
        self.words[sector].get(index).copied().unwrap_or(BLANK)
    }

    fn program(&mut self, sector: usize, index: usize, word: u32) {
        let Some(is_whole) = self.act() else { return };
        // Bits go from 1 to 0 alone; a loss of power leaves any of them.
        let spared = if is_whole { 0 } else { self.random() };
        self.words[sector][index] &= word | spared;
    }

    fn erase(&mut self, sector: usize) {
        let Some(is_whole) = self.act() else { return };
        self.erased += 1;
        for index in 0..WORDS_OF_SECTOR {
            let word = if is_whole { BLANK } else { self.words[sector][index] | self.random() };
            self.words[sector][index] = word;
            if !is_whole && self.random().is_multiple_of(4) {
                self.words[sector][index] = [0, BLANK, word][self.random() as usize % 3];
            }
        }
    }
}

fn fault(value: i32) -> Occurrence {
    Occurrence { time_us: u64::MAX - value as u64, code: FaultCode::OverPressure, channel: 3, value }
}

/// Numbers that tests give their records, in the order in which they are read back page by page.
fn kept(memory: &Cells) -> Vec<i32> {
    let mut log = Log::new();
    log.open(memory, BootInfo { cause: BootCause::PowerOn, detail: 0 });
    read_back(&log, memory)
}

fn read_back(log: &Log, memory: &Cells) -> Vec<i32> {
    let (mut records, mut first, mut numbers) = (Vec::new(), 0, Vec::new());
    loop {
        let (state, page) = log.page(memory, first);
        assert_eq!(usize::from(state.records), page.len());
        for record in page.iter() {
            numbers.push(record.number);
            if record.kind == LogKind::Fault {
                let expected = fault(record.detail as i32);
                assert_eq!((record.time_us, record.channel), (expected.time_us, expected.channel));
                assert_eq!(record.code, FaultCode::OverPressure as u8);
                records.push(record.detail as i32);
            } else {
                assert_eq!((record.kind.known(), record.code), (Some(LogKind::Boot), BootCause::Panic as u8));
                records.push(-(record.detail as i32));
            }
        }
        if state.until == state.next {
            break;
        }
        assert!(state.until > first || first == 0, "a page that goes on");
        first = state.until;
    }
    assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
    records
}

/// One start of the device, with as many faults as given; the records that are stored whole, negative ones of starts.
fn life(memory: &mut Cells, name: &mut i32, faults: i32) -> Vec<i32> {
    let mut stored = Vec::new();
    prepare(memory);
    let mut log = Log::new();
    *name += 1;
    let first = *name;
    log.open(memory, BootInfo { cause: BootCause::Panic, detail: first as u32 });
    for number in 0..=faults {
        if number > 0 {
            *name += 1;
            log.note(Entry::fault(&fault(*name)));
        }
        let before = log.slot;
        for _ in 0..WORDS {
            log.work(memory);
        }
        if log.slot > before && !memory.is_off() {
            stored.push(if number == 0 { -first } else { *name });
        }
    }
    stored
}

/// Several lives: enough to erase each sector twice.
fn lives(memory: &mut Cells) -> Vec<i32> {
    let mut name = 0;
    (0..18).flat_map(|round| life(memory, &mut name, 1 + round % 4)).collect()
}

/// The records in the log are the newest of those stored, without a gap, and at least `least` of them.
#[track_caller]
fn is_newest_part(kept: &[i32], stored: &[i32], least: usize, place: &str) {
    assert!(stored.ends_with(kept), "{place}: {kept:?} of {stored:?}");
    assert!(kept.len() >= stored.len().min(least), "{place}: {kept:?} of {stored:?}");
}

/// Three quarters of a sector, less a place that a loss of power has spoiled.
const LEAST: usize = 3 * KEPT_OF_SECTOR / 4 - 1;

#[test]
fn log_goes_round_and_keeps_the_newest_part() {
    let mut memory = Cells::delivered();
    let stored = lives(&mut memory);
    assert!(memory.erased >= 5, "{} erasures", memory.erased);
    assert!(stored.len() > 4 * KEPT_OF_SECTOR);
    is_newest_part(&kept(&memory), &stored, LEAST + 1, "at the end");
}

#[test]
fn power_cut_at_every_word_and_in_every_erasure_loses_the_record_in_work_alone() {
    let mut whole = Cells::delivered();
    lives(&mut whole);
    let (mut cuts, mut cut_erasures) = (0, 0);
    for power in 1..=whole.done {
        for seed in 1..8_u32 {
            let mut memory = Cells { power, seed: seed.wrapping_mul(0x9e37_79b9), ..Cells::delivered() };
            let erased = memory.erased;
            let stored = lives(&mut memory);
            assert!(memory.is_off());
            cut_erasures += u32::from(memory.erased > erased);
            cuts += 1;
            let place = format!("power for {power} acts, seed {seed}");
            is_newest_part(&kept(&memory), &stored, LEAST, &place);
            // Power comes back, twice, and the log goes on behind what it had.
            memory.power = usize::MAX;
            let mut name = 10_000;
            let mut all = stored;
            for _ in 0..2 {
                all.extend(life(&mut memory, &mut name, 2));
                is_newest_part(&kept(&memory), &all, LEAST, &place);
            }
        }
    }
    println!("{cuts} cuts");
    assert!(whole.done > 300 && cuts == 7 * whole.done && cut_erasures > 0);
}

#[test]
fn power_cut_while_the_log_is_mended_is_mended_too() {
    let mut whole = Cells::delivered();
    lives(&mut whole);
    for power in 1..=whole.done {
        let mut memory = Cells { power, seed: 77, ..Cells::delivered() };
        let mut stored = lives(&mut memory);
        let mut name = 10_000;
        for second in 1..24 {
            memory.power = second;
            stored.extend(life(&mut memory, &mut name, 1));
            // Each loss of power may have spoiled a place.
            let least = LEAST.saturating_sub(second);
            is_newest_part(&kept(&memory), &stored, least, &format!("power for {power} acts, then for {second}"));
        }
    }
}

#[test]
fn memory_that_takes_nothing_is_noticed_once_and_the_device_goes_on() {
    let mut memory =
        Cells { is_fixed: true, words: [vec![0; WORDS_OF_SECTOR], vec![0; WORDS_OF_SECTOR]], ..Cells::delivered() };
    assert_eq!(life(&mut memory, &mut 0, 3), [], "never prepared");
    let mut memory = Cells::delivered();
    prepare(&mut memory);
    memory.is_fixed = true;
    let mut log = Log::new();
    log.open(&memory, BootInfo { cause: BootCause::Panic, detail: 1 });
    for _ in 0..100 {
        log.work(&mut memory);
    }
    let (state, records) = log.page(&memory, 0);
    assert_eq!((state.condition.known(), state.unstored, records.len()), (Some(LogCondition::Failed), 1, 0));
    log.note(Entry::fault(&fault(1)));
    assert_eq!(log.page(&memory, 0).0.unstored, 2);
}

#[test]
fn full_log_counts_what_it_does_not_store_until_the_next_start() {
    let mut memory = Cells::delivered();
    let mut name = 0;
    let stored = life(&mut memory, &mut name, 40);
    assert_eq!(memory.erased, 1, "nothing is erased while the device runs");
    let kept_now = kept(&memory);
    assert_eq!(kept_now, stored[..KEPT_OF_SECTOR]);
    let mut log = Log::new();
    log.open(&memory, BootInfo { cause: BootCause::Panic, detail: 1 });
    let state = log.page(&memory, 0).0;
    assert_eq!((state.condition.known(), state.unstored), (Some(LogCondition::Full), 1));
    let next = life(&mut memory, &mut name, 2);
    assert_eq!(memory.erased, 2);
    assert_eq!(kept(&memory), [&kept_now[..], &next[..]].concat());
}

#[test]
fn more_records_than_can_wait_are_counted() {
    let mut memory = Cells::delivered();
    prepare(&mut memory);
    let mut log = Log::new();
    log.open(&memory, BootInfo { cause: BootCause::Panic, detail: 0 });
    (1..=20).for_each(|value| log.note(Entry::fault(&fault(value))));
    assert_eq!(log.page(&memory, 0).0.unstored, 5, "sixteen places, one of them for the start");
}

#[test]
fn turn_programs_one_word() {
    let mut memory = Cells::delivered();
    prepare(&mut memory);
    let before = memory.done;
    let mut log = Log::new();
    log.open(&memory, BootInfo { cause: BootCause::Panic, detail: 0 });
    for word in 1..=WORDS {
        log.work(&mut memory);
        assert_eq!(memory.done, before + word, "one word a turn");
    }
    log.work(&mut memory);
    assert_eq!(memory.done, before + WORDS);
}
