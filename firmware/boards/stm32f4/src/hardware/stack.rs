//! Largest use of the stack: it is painted at start, and words without paint were used.

use core::ptr::{addr_of, read_volatile, write_volatile};

const PAINT: u32 = 0xc0de_57ac;
/// Below the stack pointer of the painter, bytes that it may itself use.
const OWN: usize = 256;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Addresses of the lowest word, and behind the highest.
#[must_use]
pub fn bounds() -> (usize, usize) {
    (addr_of!(_stack_end) as usize, addr_of!(_stack_start) as usize)
}

/// Paints what is not in use yet. Call it once, early, with interrupts off.
pub fn paint() {
    let (lowest, _) = bounds();
    let top = cortex_m::register::msp::read() as usize - OWN;
    for address in (lowest..top).step_by(4) {
        // SAFETY: the words belong to the stack and lie below all that is in use.
        unsafe { write_volatile(address as *mut u32, PAINT) }
    }
}

/// The most that has been in use since it was painted, bytes.
#[must_use]
pub fn used() -> u16 {
    let (lowest, highest) = bounds();
    // SAFETY: the words belong to the stack; one that is being written is not paint, whichever of its values is read.
    let is_paint = |address: &usize| unsafe { read_volatile(*address as *const u32) == PAINT };
    let paint = (lowest..highest).step_by(4).take_while(is_paint).count();
    u16::try_from(highest - lowest - 4 * paint).unwrap_or(u16::MAX)
}
