//! Times of the independent watchdog, which counts an oscillator of its own: it resets a chip whose every other clock has stopped.

/// Frequency of that oscillator, Hz: nominal, lowest, highest. Data sheets of STM32F405 and STM32F446, "LSI oscillator characteristics".
const OSCILLATOR_HZ: [u32; 3] = [32_000, 17_000, 47_000];

/// Periods of the oscillator in a count, with 0 in IWDG_PR (RM0090, "Prescaler register").
const PRESCALER: u32 = 4;

/// Time within which the watchdog has to be fed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    counts: u32,
}

impl Window {
    /// For the start: it may wait 20 ms for a crystal. No fill valve has current then.
    pub const STARTING: Self = Self::nominal_ms(100);

    /// While the controller runs, which ends a turn every millisecond.
    pub const RUNNING: Self = Self::nominal_ms(10);

    const fn nominal_ms(time_ms: u32) -> Self {
        Self { counts: time_ms * (OSCILLATOR_HZ[0] / 1_000) / PRESCALER }
    }

    /// Value of IWDG_RLR, 12 bits: the counter starts there and resets the chip behind 0.
    #[must_use]
    pub const fn reload(self) -> u16 {
        (self.counts - 1) as u16
    }

    /// Shortest and longest time, us, over all that the oscillator may be.
    #[must_use]
    pub fn bounds_us(self) -> [u32; 2] {
        let [_, lowest_hz, highest_hz] = OSCILLATOR_HZ;
        [highest_hz, lowest_hz].map(|hz| (self.counts * PRESCALER).saturating_mul(1_000_000 / 1_000) / (hz / 1_000))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_fit_the_register_and_are_those_of_the_page() {
        let page = include_str!("../../../../docs/explanation/device.md");
        for (window, reload, text) in [(Window::STARTING, 799, "68 to 188 ms"), (Window::RUNNING, 79, "6.8 to 18.8 ms")]
        {
            assert_eq!(window.reload(), reload);
            assert!(window.reload() <= 0xfff, "12 bits");
            let [shortest, longest] = window.bounds_us().map(|time_us| f64::from(time_us) * 1e-3);
            // Periods of 47 kHz and of 17 kHz.
            let periods = f64::from(4 * (window.reload() + 1));
            assert!((shortest - periods / 47.0).abs() < 0.01 && (longest - periods / 17.0).abs() < 0.01);
            let digits = usize::from(longest < 100.0);
            assert_eq!(format!("{shortest:.digits$} to {longest:.digits$} ms"), text);
            assert!(page.contains(text), "{text}");
        }
        assert!(Window::RUNNING.bounds_us()[0] > 6 * 1_000, "six turns may be late");
    }
}
