//! One direction of the serial line: bytes take their time and may be hurt on the way.

use std::collections::VecDeque;

use crate::noise::Noise;
use crate::settings::LineFaults;

/// Start bit, eight data bits, stop bit.
const BITS_PER_BYTE: u64 = 10;

/// Random numbers that a byte takes.
const DRAWS: u64 = 4;

/// Bytes on their way. Times are the host's, in nanoseconds.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    byte_ns: u64,
    /// When the last byte handed over will have left.
    free_ns: u64,
    /// Arrival time and value.
    bytes: VecDeque<(u64, u8)>,
    faults: LineFaults,
    noise: Noise,
}

impl Line {
    pub(crate) fn new(baud: u32, faults: LineFaults, noise: Noise) -> Self {
        let byte_ns = BITS_PER_BYTE * 1_000_000_000 / u64::from(baud);
        Self { byte_ns, free_ns: 0, bytes: VecDeque::new(), faults, noise }
    }

    /// Changes what happens to bytes handed over from now on.
    pub(crate) fn set_faults(&mut self, faults: LineFaults) {
        self.faults = faults;
    }

    /// Hands bytes over; they leave one after another.
    pub(crate) fn write(&mut self, now_ns: u64, bytes: &[u8]) {
        if self.faults != LineFaults::NONE {
            bytes.iter().for_each(|byte| self.send(now_ns, *byte));
            return;
        }
        // No draw would change a byte.
        self.noise.skip(DRAWS * bytes.len() as u64);
        for &byte in bytes {
            self.free_ns = self.free_ns.max(now_ns) + self.byte_ns;
            self.bytes.push_back((self.free_ns, byte));
        }
    }

    fn send(&mut self, now_ns: u64, byte: u8) {
        // All are drawn for every byte, so that switching one off leaves the others as they were.
        let dropped = self.noise.happens(self.faults.drop);
        let flipped = self.noise.happens(self.faults.flip);
        let doubled = self.noise.happens(self.faults.duplicate);
        let bit = self.noise.next() % 8;
        let received = if flipped { byte ^ (1 << bit) } else { byte };
        for _ in 0..=u8::from(doubled) {
            self.free_ns = self.free_ns.max(now_ns) + self.byte_ns;
            if !dropped {
                self.bytes.push_back((self.free_ns, received));
            }
        }
    }

    /// The next byte that has arrived.
    pub(crate) fn read(&mut self, now_ns: u64) -> Option<u8> {
        if !self.is_readable(now_ns) {
            return None;
        }
        self.bytes.pop_front().map(|(_, byte)| byte)
    }

    /// Whether a byte has arrived.
    pub(crate) fn is_readable(&self, now_ns: u64) -> bool {
        self.bytes.front().is_some_and(|&(arrival_ns, _)| arrival_ns <= now_ns)
    }

    /// Bytes handed over that have not left yet.
    pub(crate) fn backlog(&self, now_ns: u64) -> usize {
        self.free_ns.saturating_sub(now_ns).div_ceil(self.byte_ns) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(faults: LineFaults) -> Line {
        Line::new(1_000_000, faults, Noise::new(7, 0))
    }

    fn received(line: &mut Line, now_ns: u64) -> Vec<u8> {
        std::iter::from_fn(|| line.read(now_ns)).collect()
    }

    #[test]
    fn byte_takes_ten_bits_and_waits_for_the_one_before() {
        let mut line = line(LineFaults::NONE);
        line.write(5_000, &[1, 2, 3]);
        assert_eq!(line.backlog(5_000), 3);
        assert_eq!(received(&mut line, 14_999), []);
        assert_eq!(received(&mut line, 15_000), [1]);
        assert_eq!(line.backlog(15_000), 2);
        assert_eq!(received(&mut line, 35_000), [2, 3]);
        line.write(100_000, &[4]);
        assert!(!line.is_readable(109_999));
        assert!(line.is_readable(110_000), "an idle line starts at once");
    }

    #[test]
    fn cut_line_delivers_nothing() {
        let mut line = line(LineFaults::CUT);
        line.write(0, &[1; 1_000]);
        assert_eq!(received(&mut line, u64::MAX), []);
    }

    #[test]
    fn flip_changes_one_bit_and_a_duplicate_comes_at_once() {
        let mut flipping = line(LineFaults { flip: 1.0, ..LineFaults::NONE });
        flipping.write(0, &[0x55; 100]);
        assert!(received(&mut flipping, u64::MAX).iter().all(|byte| (byte ^ 0x55).count_ones() == 1));
        let mut doubling = line(LineFaults { duplicate: 1.0, ..LineFaults::NONE });
        doubling.write(0, &[1, 2]);
        assert_eq!(received(&mut doubling, u64::MAX), [1, 1, 2, 2]);
    }

    #[test]
    fn faults_are_the_same_after_bytes_without_any() {
        let faults = LineFaults { drop: 0.1, flip: 0.2, duplicate: 0.1 };
        let (mut drawn, mut skipped) =
            (line(LineFaults { drop: f64::MIN_POSITIVE, ..LineFaults::NONE }), line(LineFaults::NONE));
        for line in [&mut drawn, &mut skipped] {
            line.write(0, &[3; 100]);
            line.set_faults(faults);
            line.write(0, &[5; 1_000]);
        }
        assert_eq!(drawn.bytes, skipped.bytes);
    }

    #[test]
    fn faults_come_as_often_as_asked() {
        let mut line = line(LineFaults { drop: 0.1, ..LineFaults::NONE });
        line.write(0, &vec![0; 100_000]);
        let arrived = received(&mut line, u64::MAX).len();
        // Five standard deviations of the binomial distribution: sqrt(1e5 * 0.1 * 0.9) = 95.
        assert!(arrived.abs_diff(90_000) < 475, "{arrived}");
    }
}
