//! The board as far as an emulator has it: a counter, a way to print, a way out.

#![allow(dead_code, reason = "each image uses a part of it")]

use core::fmt::Arguments;
use core::hint::black_box;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio;

/// The system timer counts from here to zero, 24 bits.
const LARGEST: u32 = 0x00ff_ffff;

/// Passes of the timer through zero since its last start.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

/// A dozen instructions in sixteen million counts.
#[exception]
fn SysTick() {
    ROUNDS.fetch_add(1, Ordering::Relaxed);
}

/// The system timer, which counts the processor's clock downwards.
pub(crate) struct Counter {
    timer: SYST,
}

impl Counter {
    /// Starts it; `None` the second time.
    pub(crate) fn start() -> Option<Self> {
        let mut timer = cortex_m::Peripherals::take()?.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(LARGEST);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        Some(Self { timer })
    }

    /// Begins a stretch of counting.
    #[inline(always)]
    pub(crate) fn begin(&mut self) -> u32 {
        self.timer.clear_current();
        // The first count loads the counter.
        while SYST::get_current() == 0 {}
        ROUNDS.store(0, Ordering::Relaxed);
        SYST::get_current()
    }

    /// Counts since it began, modulo 2^32.
    #[inline(always)]
    pub(crate) fn end(&self, begin: u32) -> u32 {
        let now = SYST::get_current();
        let rounds = ROUNDS.load(Ordering::Relaxed);
        // At zero the round is over and the next has not begun.
        let left = if now == 0 { LARGEST + 1 } else { now };
        (rounds << LARGEST.count_ones()).wrapping_add(begin).wrapping_sub(left)
    }
}

/// A place that a trace of the program passes just before a stretch that is counted. Two such places have different bodies, or the linker
/// would make one of them.
#[inline(never)]
pub(crate) fn stretch_begins() {
    black_box(1_u32);
}

/// The same just after it.
#[inline(never)]
pub(crate) fn stretch_ends() {
    black_box(2_u32);
}

/// Prints on the terminal of the emulator; an emulator without one is told nothing.
pub(crate) fn print(line: Arguments<'_>) {
    use core::fmt::Write;
    if let Ok(mut terminal) = hio::hstdout() {
        let _ = terminal.write_fmt(line);
    }
}

/// Ends the emulation.
pub(crate) fn leave(well: bool) -> ! {
    debug::exit(if well { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let line = info.location().map_or(0, core::panic::Location::line);
    print(format_args!("panic in line {line}\n"));
    leave(false)
}
