//! The end of a program that cannot go on: let the air out, remember why, start anew.
//!
//! The ports come first, by constants and addresses alone: nothing in memory can be relied on by then.

use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::ptr::{addr_of_mut, read_volatile, write_volatile};

use cortex_m::peripheral::SCB;

use super::ports;
use crate::record::Crash;
use crate::schedule::VENTING;

/// Memory that the start-up leaves alone.
#[unsafe(link_section = ".uninit.RECORD")]
static mut RECORD: MaybeUninit<[u32; 4]> = MaybeUninit::uninit();

/// The crash that ended the program before, and forgets it.
pub fn take() -> Option<Crash> {
    let record = addr_of_mut!(RECORD).cast::<[u32; 4]>();
    // SAFETY: the memory is this program's alone and any bits are words; it is touched at start and at the end only.
    unsafe {
        let crash = Crash::from_words(read_volatile(record));
        write_volatile(record, [0; 4]);
        crash
    }
}

/// No interrupt any more, all vents on, all else off.
#[inline(always)]
fn let_go() {
    cortex_m::interrupt::disable();
    ports::apply(&VENTING);
}

/// Lets the air out, remembers, starts anew. Needs a stack of some words and nothing else.
pub fn stop(crash: Crash) -> ! {
    let_go();
    // SAFETY: as above; nothing else runs any more.
    unsafe { write_volatile(addr_of_mut!(RECORD).cast::<[u32; 4]>(), crash.to_words()) };
    SCB::sys_reset()
}

/// For the panic handler of an image.
pub fn panicked(info: &PanicInfo<'_>) -> ! {
    let_go();
    stop(Crash::Panic { line: info.location().map_or(0, core::panic::Location::line) })
}

/// For the handler of the interrupt that cannot be masked. On these chips the clock security system alone raises it.
pub extern "C" fn clock_failed() -> ! {
    stop(Crash::ClockFailed)
}

/// For the fault handler of an image: `frame` is where the stack was.
pub extern "C" fn faulted(frame: u32) -> ! {
    let_go();
    // The sixth word that the processor puts on the stack is the address of the instruction; where there is no stack there is none.
    let (lowest, highest) = super::stack::bounds();
    let address = if (lowest..highest.saturating_sub(32)).contains(&(frame as usize)) {
        // SAFETY: the word lies in the stack.
        unsafe { read_volatile((frame as usize + 24) as *const u32) }
    } else {
        0
    };
    stop(Crash::HardFault { address })
}
