//! The independent watchdog.

use stm32f4xx_hal::pac::IWDG;

use crate::watchdog::Window;

/// Values of IWDG_KR (RM0090, "Key register").
const START: u16 = 0xcccc;
const UNLOCK: u16 = 0x5555;
const FEED: u16 = 0xaaaa;

/// Looks at a register that has not taken its value yet: some milliseconds, fifty times what that takes.
const LOOKS: u32 = 100_000;

/// The watchdog, running.
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts it, for good: only a reset stops it.
    #[must_use]
    pub fn start(watchdog: IWDG, window: Window) -> Self {
        let started = Self(watchdog);
        started.set(window);
        started.key(START);
        started
    }

    /// Changes its window and feeds it. Where the register takes nothing, the window stays as it was.
    pub fn change(&self, window: Window) {
        let _ = (0..LOOKS).any(|_| self.0.sr().read().rvu().bit_is_clear());
        self.set(window);
    }

    /// Feeds it.
    pub fn feed(&self) {
        self.key(FEED);
    }

    fn set(&self, window: Window) {
        self.key(UNLOCK);
        // SAFETY: 12 bits, as a test shows; the prescaler stays at its reset value, 4.
        self.0.rlr().write(|w| unsafe { w.bits(window.reload()) });
        // Locks it again, too.
        self.key(FEED);
    }

    fn key(&self, key: u16) {
        // SAFETY: the key register takes any value and acts on three.
        self.0.kr().write(|w| unsafe { w.key().bits(key) });
    }
}
