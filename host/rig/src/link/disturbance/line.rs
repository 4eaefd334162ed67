//! One direction of a disturbed link.

use std::collections::VecDeque;

use softlimb_numerics::Random;

use super::faults::LinkFaults;

/// What separates two frames.
const DELIMITER: u8 = 0;

/// Counts of the faults of one direction, by their kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disturbances {
    /// Frames taken.
    pub frames: u64,
    /// Frames lost.
    pub lost: u64,
    /// Frames whose bytes were altered: flips, bursts, cuts, wrong baud rates.
    pub altered: u64,
    /// Frames repeated.
    pub repeated: u64,
    /// Frames that came after their successor.
    pub reordered: u64,
    /// Insertions of random bytes.
    pub garbage: u64,
    /// Stalls.
    pub stalls: u64,
}

/// Frames in, bytes out, in order but where a fault has it otherwise.
#[derive(Debug)]
pub(super) struct DisturbedLine {
    faults: LinkFaults,
    random: Random,
    /// Bytes of a frame whose delimiter has not come.
    begun: Vec<u8>,
    /// The frame that comes after the next one.
    held_back: Option<Vec<u8>>,
    /// Times from which on they may pass, us, and bytes.
    waiting: VecDeque<(u64, Vec<u8>)>,
    stalled_until_us: u64,
    disturbances: Disturbances,
}

impl DisturbedLine {
    pub(super) fn new(faults: LinkFaults, random: Random) -> Self {
        Self {
            faults,
            random,
            begun: Vec::new(),
            held_back: None,
            waiting: VecDeque::new(),
            stalled_until_us: 0,
            disturbances: Disturbances::default(),
        }
    }

    pub(super) fn disturbances(&self) -> Disturbances {
        self.disturbances
    }

    /// Takes bytes in any chunking. A frame is held until its last byte has come: nobody could read it earlier.
    pub(super) fn take(&mut self, now_us: u64, bytes: &[u8]) {
        for &byte in bytes {
            self.begun.push(byte);
            if byte == DELIMITER && self.begun.len() > 1 {
                let frame = std::mem::take(&mut self.begun);
                self.pass(now_us, frame);
            }
        }
    }

    /// Appends what may pass by now.
    pub(super) fn deliver(&mut self, now_us: u64, into: &mut Vec<u8>) {
        while self.waiting.front().is_some_and(|&(from_us, _)| from_us <= now_us) {
            into.extend(self.waiting.pop_front().map(|(_, bytes)| bytes).unwrap_or_default());
        }
    }

    /// When the next bytes may pass, us.
    pub(super) fn due_us(&self) -> Option<u64> {
        self.waiting.front().map(|&(from_us, _)| from_us)
    }

    /// Both delimiters go with the frame between them, where the first has not ended the frame before.
    fn pass(&mut self, now_us: u64, mut frame: Vec<u8>) {
        let faults = self.faults;
        // All are drawn for every frame, so that switching one off leaves the others as they were.
        let [lost, flipped, burst, cut, twice, late, garbage, noise, stalled] = [
            faults.loss,
            faults.flip,
            faults.burst,
            faults.cut,
            faults.duplicate,
            faults.reorder,
            faults.garbage,
            faults.wrong_baud,
            faults.stall,
        ]
        .map(|share| self.random.uniform() < share);
        self.disturbances.frames += 1;
        if stalled {
            self.disturbances.stalls += 1;
            self.stalled_until_us = self.stalled_until_us.max(now_us) + faults.stall_us;
        }
        if garbage {
            self.disturbances.garbage += 1;
            let bytes = (0..=self.random.index(64)).map(|_| self.byte()).collect();
            self.queue(now_us, bytes);
        }
        if lost {
            self.disturbances.lost += 1;
            return;
        }
        self.alter(&mut frame, [flipped, burst, cut, noise]);
        self.disturbances.repeated += u64::from(twice);
        let copy = twice.then(|| frame.clone());
        if late && self.held_back.is_none() {
            self.disturbances.reordered += 1;
            self.held_back = Some(frame);
        } else {
            self.queue(now_us, frame);
            let earlier = self.held_back.take();
            earlier.into_iter().for_each(|frame| self.queue(now_us, frame));
        }
        copy.into_iter().for_each(|frame| self.queue(now_us, frame));
    }

    fn queue(&mut self, now_us: u64, bytes: Vec<u8>) {
        self.waiting.push_back((self.stalled_until_us.max(now_us), bytes));
    }

    fn alter(&mut self, frame: &mut Vec<u8>, [flipped, burst, cut, noise]: [bool; 4]) {
        self.disturbances.altered += u64::from(flipped || burst || cut || noise);
        if flipped {
            for _ in 0..=self.random.index(4) {
                let place = self.random.index(frame.len());
                frame[place] ^= 1 << self.random.index(8);
            }
        }
        if burst {
            let (place, length) = (self.random.index(frame.len()), 2 + self.random.index(7));
            let random = &mut self.random;
            frame.iter_mut().skip(place).take(length).for_each(|byte| *byte = random.index(256) as u8);
        }
        if noise {
            let random = &mut self.random;
            frame.iter_mut().for_each(|byte| *byte = random.index(256) as u8);
        }
        if cut {
            frame.truncate(self.random.index(frame.len()));
        }
    }

    fn byte(&mut self) -> u8 {
        self.random.index(256) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [u8; 8] = [0, 7, 1, 2, 3, 4, 5, 0];

    fn line(faults: LinkFaults) -> DisturbedLine {
        DisturbedLine::new(faults, Random::new(5, 0))
    }

    fn passed(line: &mut DisturbedLine, now_us: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        line.deliver(now_us, &mut bytes);
        bytes
    }

    #[test]
    fn perfect_line_passes_every_byte_in_any_chunking() {
        let mut line = line(LinkFaults::NONE);
        let sent = [FRAME, FRAME].concat();
        sent.chunks(3).for_each(|bytes| line.take(0, bytes));
        assert_eq!(passed(&mut line, 0), sent);
        assert_eq!(line.disturbances(), Disturbances { frames: 2, ..Disturbances::default() });
    }

    #[test]
    fn each_fault_does_what_its_name_says() {
        let sent: Vec<u8> = (0..200).flat_map(|i| [0, i % 50 + 1, 9, 9, 9, 9, 0]).collect();
        let through = |faults: LinkFaults| {
            let mut line = line(faults);
            line.take(0, &sent);
            (passed(&mut line, 0), line.disturbances())
        };
        let (lossy, counted) = through(LinkFaults { loss: 0.25, ..LinkFaults::NONE });
        assert_eq!(lossy.len(), sent.len() - 7 * counted.lost as usize);
        assert!((25..=75).contains(&counted.lost), "{counted:?}");
        let (doubled, _) = through(LinkFaults { duplicate: 1.0, ..LinkFaults::NONE });
        assert_eq!(doubled.chunks(14).map(|two| &two[..7]).collect::<Vec<_>>().concat(), sent);
        let (flipped, _) = through(LinkFaults { flip: 1.0, ..LinkFaults::NONE });
        for (was, is) in sent.chunks(7).zip(flipped.chunks(7)) {
            let bits: u32 = was.iter().zip(is).map(|(a, b)| (a ^ b).count_ones()).sum();
            assert!(bits <= 4, "{was:?} {is:?}");
        }
        let (swapped, _) = through(LinkFaults { reorder: 1.0, ..LinkFaults::NONE });
        assert_eq!(swapped[..14], [&sent[7..14], &sent[..7]].concat());
        assert_eq!(swapped.len(), sent.len());
        let (cut, counted) = through(LinkFaults { cut: 1.0, ..LinkFaults::NONE });
        assert!(cut.len() < sent.len() && counted.altered == 200);
        let (noisy, counted) = through(LinkFaults { garbage: 1.0, ..LinkFaults::NONE });
        assert!(noisy.len() >= sent.len() + 200 && noisy.len() <= sent.len() + 200 * 64 && counted.garbage == 200);
    }

    #[test]
    fn stall_holds_everything_and_loses_nothing() {
        let mut line = line(LinkFaults { stall: 1.0, stall_us: 1_000, ..LinkFaults::NONE });
        line.take(500, &FRAME);
        assert_eq!(line.due_us(), Some(1_500));
        assert!(passed(&mut line, 1_499).is_empty());
        line.take(1_499, &FRAME);
        assert_eq!(passed(&mut line, 1_500), FRAME);
        assert_eq!(passed(&mut line, 2_500), FRAME);
    }
}
