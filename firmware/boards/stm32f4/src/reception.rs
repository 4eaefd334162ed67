//! Counts of serial-port errors by kind.

use core::sync::atomic::{AtomicU32, Ordering};

use softlimb_protocol::LinkErrors;

/// Bits of USART_SR (RM0090, "Status register").
const PARITY: u32 = 1;
const FRAMING: u32 = 1 << 1;
const NOISE: u32 = 1 << 2;
const OVERRUN: u32 = 1 << 3;
const NOT_EMPTY: u32 = 1 << 5;

/// Status bits that require a read of the data register, which clears them.
pub const PENDING: u32 = PARITY | FRAMING | NOISE | OVERRUN | NOT_EMPTY;

/// Error counts since the device started. Each stops at its maximum. Only the link's interrupt writes them.
pub struct ErrorCounts {
    overrun: AtomicU32,
    framing: AtomicU32,
    noise: AtomicU32,
    parity: AtomicU32,
    queue_full: AtomicU32,
}

impl ErrorCounts {
    /// All counts at zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            overrun: AtomicU32::new(0),
            framing: AtomicU32::new(0),
            noise: AtomicU32::new(0),
            parity: AtomicU32::new(0),
            queue_full: AtomicU32::new(0),
        }
    }

    /// Counts the errors in a port status. Returns whether the received byte is intact.
    pub fn take(&self, status: u32) -> bool {
        let counts = [(OVERRUN, &self.overrun), (FRAMING, &self.framing), (NOISE, &self.noise), (PARITY, &self.parity)];
        let mut is_good = status & NOT_EMPTY != 0;
        for (_, count) in counts.into_iter().filter(|(error, _)| status & error != 0) {
            increment(count);
            is_good = false;
        }
        is_good
    }

    /// Counts an intact byte that the full receive queue cannot hold.
    pub fn take_without_place(&self) {
        increment(&self.queue_full);
    }

    /// Current counts.
    #[must_use]
    pub fn now(&self) -> LinkErrors {
        let count = |count: &AtomicU32| count.load(Ordering::Relaxed);
        LinkErrors {
            overrun: count(&self.overrun),
            framing: count(&self.framing),
            noise: count(&self.noise),
            parity: count(&self.parity),
            queue_full: count(&self.queue_full),
        }
    }
}

impl Default for ErrorCounts {
    fn default() -> Self {
        Self::new()
    }
}

/// Saturating increment of a count with one writer.
fn increment(count: &AtomicU32) {
    count.store(count.load(Ordering::Relaxed).saturating_add(1), Ordering::Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Idle line, transmitter empty, transmission complete: no errors of reception.
    const OTHERS: u32 = 1 << 4 | 1 << 6 | 1 << 7;

    #[test]
    fn every_error_is_counted_and_none_of_its_bytes_is_good() {
        // Numbers of the bits as the manual has them: PE, FE, NF, ORE, RXNE.
        for bits in 0..1 << 6 {
            let counts = ErrorCounts::new();
            let is_set = |bit: u32| bits >> bit & 1;
            let is_good = counts.take(bits | OTHERS);
            let expected = LinkErrors {
                parity: is_set(0),
                framing: is_set(1),
                noise: is_set(2),
                overrun: is_set(3),
                queue_full: 0,
            };
            assert_eq!(counts.now(), expected, "{bits:#08b}");
            assert_eq!(is_good, bits & 0b1111 == 0 && is_set(5) == 1, "{bits:#08b}");
            assert_eq!(bits & PENDING != 0, bits & 0b10_1111 != 0, "{bits:#08b}");
        }
    }

    #[test]
    fn counts_add_up_and_stay_at_their_maximum() {
        let counts = ErrorCounts::new();
        for _ in 0..300 {
            counts.take(1 << 3 | 1 << 5);
            counts.take(1 << 5);
            counts.take_without_place();
        }
        counts.take(1 << 1 | 1 << 2 | 1 << 5);
        assert_eq!(counts.now(), LinkErrors { overrun: 300, framing: 1, noise: 1, parity: 0, queue_full: 300 });
        let counts = ErrorCounts { noise: AtomicU32::new(u32::MAX), ..ErrorCounts::new() };
        counts.take(1 << 2);
        assert_eq!(counts.now(), LinkErrors { noise: u32::MAX, ..LinkErrors::NONE });
    }
}
