//! The schedule on its way from the controller to the interrupt that applies it: two halves, one in use, one being written.

use core::arch::naked_asm;
use core::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};

use crate::pins::PORTS;
use crate::schedule::{OFF, SLOTS, Words, late};

/// A place to stop at for whoever watches every tick: it does nothing, and its first instruction can be left out.
#[unsafe(naked)]
#[unsafe(no_mangle)]
pub extern "C" fn tick_begins() {
    naked_asm!("nop", "bx lr")
}

/// Both halves.
#[repr(C)]
pub struct Coils {
    halves: [[[AtomicU32; PORTS]; SLOTS]; 2],
    /// The half in use.
    active: AtomicUsize,
    /// The other half is complete.
    fresh: AtomicBool,
}

/// The schedule of this device. Its name is what an emulator finds it by.
#[unsafe(no_mangle)]
pub static COILS: Coils = Coils {
    halves: [const { [const { [const { AtomicU32::new(0) }; PORTS] }; SLOTS] }; 2],
    active: AtomicUsize::new(0),
    fresh: AtomicBool::new(false),
};

impl Coils {
    /// Takes the schedule of the next tick. Only one caller, which [`Self::begin_tick`] may interrupt.
    pub fn put(&self, slots: &[Words; SLOTS]) {
        let next = 1 - self.active.load(Ordering::Relaxed).min(1);
        if let Some(half) = self.halves.get(next) {
            for (words, new) in half.iter().flatten().zip(slots.iter().flatten()) {
                words.store(*new, Ordering::Relaxed);
            }
            self.fresh.store(true, Ordering::Release);
        }
    }

    /// Begins a tick: uses what was put, or nothing where the controller is late. While it is writing, the half in use stays the same
    /// and is switched off, but for the digital outputs.
    pub fn begin_tick(&self) {
        let active = self.active.load(Ordering::Relaxed).min(1);
        if self.fresh.swap(false, Ordering::Acquire) {
            self.active.store(1 - active, Ordering::Relaxed);
        } else if let Some(half) = self.halves.get(active) {
            for (port, word) in half.iter().flat_map(|slot| slot.iter().enumerate()) {
                word.store(late(port, word.load(Ordering::Relaxed)), Ordering::Relaxed);
            }
        }
    }

    /// Words for the ports in a slot of the present tick.
    pub fn words(&self, slot: usize) -> Words {
        let half = self.halves.get(self.active.load(Ordering::Relaxed));
        let words = half.and_then(|half| half.get(slot));
        words.map_or(OFF, |words| words.each_ref().map(|word| word.load(Ordering::Relaxed)))
    }
}
