//! 168 MHz from what the board offers, without a wait that does not end.

use stm32f4xx_hal::pac::{DBGMCU, RCC};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

/// Clock of the processor, Hz.
pub const PROCESSOR_HZ: u32 = 168_000_000;

/// Frequency that the board feeds in, MHz, and whether a whole clock signal comes, not a crystal.
#[cfg(feature = "f446")]
const EXTERNAL: (u32, bool) = (8, true);
#[cfg(not(feature = "f446"))]
const EXTERNAL: (u32, bool) = (12, false);

/// Number of looks at the external clock before it counts as stopped: some 20 ms, ten times what a crystal takes.
const LOOKS: u32 = 50_000;

/// Source of the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The board's crystal or clock signal: good to some 50 ppm.
    External,
    /// The oscillator in the chip, good to 1 %, because the external one does not run.
    Internal,
    /// There is no chip: an emulator keeps its own time and has no oscillator to wait for.
    Emulator,
}

impl Source {
    /// Whether times are what they seem.
    #[must_use]
    pub fn is_exact(self) -> bool {
        self != Self::Internal
    }
}

/// Starts the clocks. The watchdog should run by now: what the library waits for beyond is bounded by it.
pub fn start(rcc: RCC, debug: &DBGMCU) -> (Rcc, Source) {
    let (mega_hz, is_signal) = EXTERNAL;
    rcc.cr().modify(|_, w| w.hsebyp().bit(is_signal).hseon().set_bit());
    let runs = (0..LOOKS).any(|_| rcc.cr().read().hserdy().bit_is_set());
    if runs {
        let config = Config::hse(mega_hz.MHz()).sysclk(PROCESSOR_HZ.Hz());
        let config = if is_signal { config.bypass_hse_oscillator() } else { config };
        let rcc = rcc.freeze(config);
        // RM0090, "Clock security system": from here on a clock that stops raises the interrupt that cannot be masked, and the chip goes
        // on with its internal oscillator.
        rcc.cr().modify(|_, w| w.csson().set_bit());
        return (rcc, Source::External);
    }
    rcc.cr().modify(|_, w| w.hseon().clear_bit());
    // Every chip names itself here.
    if debug.idcode().read().bits() == 0 {
        return (rcc.constrain(), Source::Emulator);
    }
    (rcc.freeze(Config::hsi().sysclk(PROCESSOR_HZ.Hz())), Source::Internal)
}
