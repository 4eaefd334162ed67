//! The image in flash.

use core::ptr::{addr_of, read_volatile};
use core::slice;

use crate::seal::{NONE, WORDS, is_whole};

/// Start of flash.
const START: usize = 0x0800_0000;

/// The seal. `cargo xtask firmware` finds it by its name.
#[used]
#[unsafe(link_section = ".image_seal")]
#[unsafe(no_mangle)]
static IMAGE_SEAL: [u32; WORDS] = NONE;

unsafe extern "C" {
    /// Address in flash of what the start-up copies into memory, and where it goes: the last part of the image.
    static __sidata: u32;
    static __sdata: u32;
    static __edata: u32;
}

/// Whether the image is what was built: 5 ms at 168 MHz.
#[must_use]
pub fn is_sealed() -> bool {
    let copied = addr_of!(__edata) as usize - addr_of!(__sdata) as usize;
    let length = addr_of!(__sidata) as usize + copied - START;
    // SAFETY: flash, which nobody writes while the program runs; the linker has put the image there.
    let image = unsafe { slice::from_raw_parts(START as *const u8, length) };
    // SAFETY: the words are a static. Volatile, because they are others than the compiler knows.
    let seal = unsafe { read_volatile(&raw const IMAGE_SEAL) };
    is_whole(image, addr_of!(IMAGE_SEAL) as usize - START, seal)
}
