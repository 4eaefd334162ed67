//! The option bytes: settings that outlast the image.

use stm32f4xx_hal::pac::FLASH;

use crate::brown_out::wanted;

/// Keys that unlock them (RM0090, "Unlocking the option bytes").
const KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];
/// FLASH_OPTCR: locked, start.
const LOCK: u32 = 1;
const START: u32 = 1 << 1;

/// Looks at a unit that is at work: seconds, where writing takes a tenth of one.
const LOOKS: u32 = 10_000_000;

/// Sets the level of the brown-out reset where it is another. The chip stands still while it is written, up to a second: call it before the
/// watchdog runs, and after power has come on only, so that no device that starts over and over wears the bytes out.
pub fn set_brown_out_level(flash: &FLASH) {
    let Some(options) = wanted(flash.optcr().read().bits()) else { return };
    let is_idle = || (0..LOOKS).any(|_| flash.sr().read().bsy().bit_is_clear());
    if !is_idle() {
        return;
    }
    // SAFETY: the order and the values are those of RM0090, "Programming user option bytes"; all other options keep their bits.
    unsafe {
        for key in KEYS {
            flash.optkeyr().write(|w| w.bits(key));
        }
        flash.optcr().write(|w| w.bits(options));
        flash.optcr().write(|w| w.bits(options | START));
        let _ = is_idle();
        flash.optcr().modify(|r, w| w.bits(r.bits() | LOCK));
    }
}
