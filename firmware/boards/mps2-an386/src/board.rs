//! The board as far as an emulator has it: a counter, a way to print, a way out.

#![allow(dead_code, reason = "each image uses a part of it")]

use core::fmt::Arguments;
use core::panic::PanicInfo;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio;

/// The counter has 24 bits.
const COUNTER: u32 = 0x00ff_ffff;

/// The system timer, which counts the processor's clock downwards.
pub(crate) struct Counter {
    timer: SYST,
}

impl Counter {
    /// Starts it; `None` the second time.
    pub(crate) fn start() -> Option<Self> {
        let mut timer = cortex_m::Peripherals::take()?.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(COUNTER);
        timer.clear_current();
        timer.enable_counter();
        Some(Self { timer })
    }

    /// Begins a stretch of counting.
    #[inline(always)]
    pub(crate) fn begin(&mut self) -> u32 {
        self.timer.clear_current();
        // The first count loads the counter.
        while SYST::get_current() == 0 {}
        let _ = self.timer.has_wrapped();
        SYST::get_current()
    }

    /// Counts since it began; `None` where there were more than the counter holds.
    #[inline(always)]
    pub(crate) fn end(&mut self, begin: u32) -> Option<u32> {
        let now = SYST::get_current();
        (!self.timer.has_wrapped()).then(|| begin - now)
    }
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
