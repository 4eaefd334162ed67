//! Reproducible randomness for the line: SplitMix64 (Steele, Lea, Flood 2014).

/// Change of the state with each number.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub(crate) struct Noise(u64);

impl Noise {
    /// A stream of its own for each seed and place.
    pub(crate) fn new(seed: u64, place: u64) -> Self {
        let mut noise = Self(seed);
        let start = noise.next() ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
        Self(start)
    }

    /// The next 64 bits.
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Leaves out numbers.
    pub(crate) fn skip(&mut self, count: u64) {
        self.0 = self.0.wrapping_add(count.wrapping_mul(STEP));
    }

    /// True with the given probability.
    pub(crate) fn happens(&mut self, probability: f64) -> bool {
        // 53 bits: uniform in 0..1, never 1.
        ((self.next() >> 11) as f64 / (1_u64 << 53) as f64) < probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generator_gives_the_published_sequence() {
        // First outputs of the reference implementation for seed 1234567.
        let mut noise = Noise(1_234_567);
        let first: Vec<_> = (0..3).map(|_| noise.next()).collect();
        assert_eq!(first, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn certain_and_impossible_are_exact() {
        let mut noise = Noise::new(1, 2);
        assert!((0..1_000).all(|_| noise.happens(1.0)));
        assert!((0..1_000).all(|_| !noise.happens(0.0)));
    }
}
