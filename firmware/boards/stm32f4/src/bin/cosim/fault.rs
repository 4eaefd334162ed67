//! Handler of a program that cannot go on: the emulation ends with a failure, which its caller sees.
#![allow(unsafe_code, reason = "the vector table's names for these two are unsafe; neither is called by the program")]

use core::panic::PanicInfo;

use cortex_m_rt::exception;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};

/// Ends the emulation.
pub(crate) fn leave(well: bool) -> ! {
    debug::exit(if well { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    leave(false)
}

#[exception]
unsafe fn DefaultHandler(_number: i16) -> ! {
    leave(false)
}

#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    leave(false)
}
