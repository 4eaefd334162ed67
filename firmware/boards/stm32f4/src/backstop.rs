//! A timer that lets go of the coils by itself. Each slot of the schedule sets it back. Where none does, it makes the transfer unit write
//! the ports: the processor has no part in that, whatever it does or does not do.

use crate::pins::PORTS;
use crate::schedule::SLOT_US;

/// Frequency of the timer's input, Hz: TIM1 gets twice the clock of its bus, which is half the processor's (RM0090, "Clocks").
pub const INPUT_HZ: u32 = 168_000_000;

/// Value of TIM1_PSC: the timer counts microseconds.
pub const PRESCALER: u32 = INPUT_HZ / 1_000_000 - 1;

/// Time from the last slot to letting go, us: ten slots. The value of TIM1_CCR1 to TIM1_CCR3.
pub const PATIENCE_US: u16 = 10 * SLOT_US;

/// Streams of DMA2 whose channel 6 is the compare event 1, 2, 3 of TIM1, one for each port (RM0090, "DMA2 request mapping").
pub const STREAMS: [usize; PORTS] = [1, 2, 6];

/// TIM1_DIER: a request to the transfer unit at the compare events 1 to 3, and no interrupt.
pub const REQUESTS: u32 = 0b111 << 9;

/// DMA_SxCR: channel 6, highest priority, words from one address in memory to one register, again and again.
pub const TRANSFER: u32 = 6 << 25 | 0b11 << 16 | 0b10 << 13 | 0b10 << 11 | 1 << 8 | 0b01 << 6;

/// DMA_SxCR: the stream runs.
pub const ENABLE: u32 = 1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timer_counts_microseconds_and_waits_for_ten_slots() {
        assert_eq!(INPUT_HZ / (PRESCALER + 1), 1_000_000);
        assert_eq!(u32::from(PATIENCE_US), 10 * 100);
        assert!(u16::try_from(PRESCALER).is_ok(), "16 bits");
    }

    #[test]
    fn transfer_has_the_fields_of_the_manual() {
        let field = |lowest: u32, bits: u32| TRANSFER >> lowest & ((1 << bits) - 1);
        assert_eq!((field(25, 3), field(16, 2)), (6, 3), "CHSEL, PL");
        assert_eq!((field(13, 2), field(11, 2)), (2, 2), "MSIZE and PSIZE: 32 bits");
        assert_eq!((field(10, 1), field(9, 1), field(8, 1)), (0, 0, 1), "MINC, PINC, CIRC");
        assert_eq!((field(6, 2), field(0, 6)), (1, 0), "DIR: from memory; no interrupt, not yet on");
        assert_eq!(REQUESTS, 1 << 9 | 1 << 10 | 1 << 11, "CC1DE, CC2DE, CC3DE");
        // Stream 0 is the converter's.
        assert!(STREAMS.iter().all(|stream| (1..8).contains(stream)));
    }
}
