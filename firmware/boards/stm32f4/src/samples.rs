//! The mean of what the converter puts into memory during a tick.
//!
//! It is rounded to the 12 bits of a single code: `adc_full_scale` of the configuration is that of the converter, on every board and in the
//! simulation.

use crate::pins::SENSORS;

/// Conversions of each sensor that memory has room for. Eleven take 50 us, so that all places are filled anew in 0.91 ms of a tick.
pub const ROUNDS: usize = 18;

/// Codes in memory: round after round.
pub const CODES: usize = ROUNDS * SENSORS;

/// Fewer new codes than this tell of a converter that has stopped or is too slow.
const ENOUGH: u32 = ROUNDS as u32 / 2;

/// Sum and number of codes of one sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mean {
    sum: u32,
    count: u32,
}

impl Mean {
    /// Of nothing.
    pub const NONE: Self = Self { sum: 0, count: 0 };

    /// Takes a code. 0 is none: it marks a place that was taken before. A sensor that reads 0 has left its range anyway.
    pub fn add(&mut self, code: u16) {
        self.sum += u32::from(code);
        self.count += u32::from(code > 0);
    }

    /// The mean, rounded to the nearest code; 0, which is outside the range of any sensor, where there were too few codes.
    #[must_use]
    pub fn code(self) -> u16 {
        if self.count < ENOUGH { 0 } else { ((self.sum + self.count / 2) / self.count) as u16 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(codes: &[u16]) -> u16 {
        let mut mean = Mean::NONE;
        codes.iter().for_each(|code| mean.add(*code));
        mean.code()
    }

    #[test]
    fn mean_is_the_nearest_code() {
        for code in [1, 2, 409, 2_048, 4_095] {
            assert_eq!(mean(&[code; ROUNDS]), code);
        }
        let codes: Vec<u16> = (1_000..1_000 + ROUNDS as u16).collect();
        assert_eq!(mean(&codes), 1_009, "1008.5 is rounded up");
        let mut codes = [500; ROUNDS];
        codes[..7].fill(501);
        assert_eq!(mean(&codes), 500);
        codes[..12].fill(501);
        assert_eq!(mean(&codes), 501);
    }

    #[test]
    fn converter_that_stops_gives_zero() {
        let mut codes = [3_000; ROUNDS];
        for missing in 0..=ROUNDS {
            codes[..missing].fill(0);
            assert_eq!(mean(&codes), if missing <= ROUNDS / 2 { 3_000 } else { 0 }, "{missing} are missing");
        }
    }

    #[test]
    fn noise_of_single_codes_shrinks_by_the_root_of_their_number() {
        // A shift register of 16 bits, taps 16, 14, 13, 11: noise that is the same in every run, even in +-100 codes.
        let mut register = 0xace1_u16;
        let mut next = || {
            for _ in 0..16 {
                let bit = (register ^ register >> 2 ^ register >> 3 ^ register >> 5) & 1;
                register = register >> 1 | bit << 15;
            }
            2_000 + register % 201 - 100
        };
        let deviation = |codes: &[u16]| {
            let squares = codes.iter().map(|code| (f64::from(*code) - 2_000.0).powi(2)).sum::<f64>();
            (squares / codes.len() as f64).sqrt()
        };
        let single: Vec<u16> = (0..4_000).map(|_| next()).collect();
        let means: Vec<u16> = (0..4_000).map(|_| mean(&std::array::from_fn::<u16, ROUNDS, _>(|_| next()))).collect();
        let gain = deviation(&single) / deviation(&means);
        assert!((gain - (ROUNDS as f64).sqrt()).abs() < 0.3, "{gain}");
    }
}
