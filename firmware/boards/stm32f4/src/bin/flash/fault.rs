//! Handler of a program that cannot go on.
#![allow(unsafe_code, reason = "a fault may come because there is no stack left: the handler begins by making one")]

use core::arch::naked_asm;
use core::panic::PanicInfo;

use softlimb_image_stm32f4::hardware::crash;

/// Takes the whole stack for itself before it uses any: an overflow would otherwise fault again, and halt for good.
///
/// # Safety
/// The processor alone calls it.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        "mrs r0, msp",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr msp, r1",
        "b {faulted}",
        faulted = sym crash::faulted,
    )
}

/// The external clock has stopped. Takes the whole stack: it may come within the handler of a fault.
///
/// # Safety
/// The processor alone calls it.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn NonMaskableInt() -> ! {
    naked_asm!(
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr msp, r1",
        "b {failed}",
        failed = sym crash::clock_failed,
    )
}

/// An interrupt that nobody serves is a fault too: the library's handler would wait in it for the watchdog.
///
/// # Safety
/// The processor alone calls it.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn DefaultHandler() -> ! {
    naked_asm!("b {fault}", fault = sym HardFault)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    crash::panicked(info)
}
