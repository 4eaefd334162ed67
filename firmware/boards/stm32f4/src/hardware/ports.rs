//! The general-purpose ports, by address: a fault has to reach them without owning them.

use core::ptr::{read_volatile, write_volatile};

use crate::pins::{EMERGENCY_STOP, OUTPUTS, PORTS, Pin, SENSOR};
use crate::schedule::Words;

/// RCC_AHB1ENR, whose lowest bits are the clocks of the ports A, B, C.
const CLOCKS: usize = 0x4002_3830;
/// GPIOA; each port is 1 KiB on.
const FIRST: usize = 0x4002_0000;
const STRIDE: usize = 0x400;

/// Registers of a port.
const MODE: usize = 0x00;
const PULL: usize = 0x0c;
const INPUT: usize = 0x10;
const SET_RESET: usize = 0x18;

/// Two bits a pin in the mode and pull registers.
const OUTPUT: u32 = 0b01;
const ANALOG: u32 = 0b11;
const PULL_UP: u32 = 0b01;
const PULL_DOWN: u32 = 0b10;
const FLOATING: u32 = 0b00;

fn register(port: usize, offset: usize) -> *mut u32 {
    (FIRST + port * STRIDE + offset) as *mut u32
}

fn write(port: usize, offset: usize, value: u32) {
    // SAFETY: `port` counts ports of the chip, and a write to these registers touches no memory.
    unsafe { write_volatile(register(port, offset), value) }
}

fn read(port: usize, offset: usize) -> u32 {
    // SAFETY: as above; reading has no effect.
    unsafe { read_volatile(register(port, offset)) }
}

/// Sets all pins of this board up: outputs are told what they shall be before they become outputs. Call it once the link's pins are,
/// before anything else; where air has to go out, earlier too.
pub fn set_up(first: &Words) {
    let clocks = CLOCKS as *mut u32;
    // SAFETY: the register exists; only bits of ports are added, and no interrupt is enabled yet.
    unsafe { write_volatile(clocks, read_volatile(clocks) | ((1 << PORTS) - 1)) };
    apply(first);
    for (port, mask) in OUTPUTS.into_iter().enumerate() {
        let pins = || (0..16).filter(move |pin| mask & 1 << pin != 0);
        pins().for_each(|pin| change(port, PULL, pin, PULL_DOWN));
        pins().for_each(|pin| change(port, MODE, pin, OUTPUT));
    }
    for (pin, _) in SENSOR {
        change(pin.port as usize, PULL, pin.number, FLOATING);
        change(pin.port as usize, MODE, pin.number, ANALOG);
    }
    change(EMERGENCY_STOP.port as usize, PULL, EMERGENCY_STOP.number, PULL_UP);
}

fn change(port: usize, offset: usize, pin: u8, bits: u32) {
    let shift = 2 * u32::from(pin);
    write(port, offset, read(port, offset) & !(0b11 << shift) | bits << shift);
}

/// Tells the ports which outputs are on.
pub fn apply(words: &Words) {
    for (port, word) in words.iter().enumerate() {
        write(port, SET_RESET, *word);
    }
}

/// Address of the register that sets and resets the outputs of a port.
#[must_use]
pub fn set_reset(port: usize) -> usize {
    register(port, SET_RESET) as usize
}

/// Whether a pin is high.
#[must_use]
pub fn is_high(pin: Pin) -> bool {
    read(pin.port as usize, INPUT) & u32::from(pin.bit()) != 0
}
