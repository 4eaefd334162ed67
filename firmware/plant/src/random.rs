//! Seeded randomness without transcendental functions: the same seed gives the same bits on
//! every platform.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// One independent stream of random numbers.
#[derive(Clone, Debug)]
pub(crate) struct Random(ChaCha8Rng);

impl Random {
    /// The stream `stream` of the seed `seed`. Streams do not overlap, so what one part of the
    /// plant draws never changes what another one gets.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Self(rng)
    }

    /// Uniform in 0..1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in -1..1.
    pub(crate) fn symmetric(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Close to the standard normal distribution and truncated at 3 standard deviations
    /// (twelve uniform numbers, drawn again outside).
    pub(crate) fn truncated_normal(&mut self) -> f64 {
        loop {
            let x = (0..12).map(|_| self.unit()).sum::<f64>() - 6.0;
            if x.abs() <= 3.0 {
                return x;
            }
        }
    }

    /// Noise of mean 0 and standard deviation 1, bounded by sqrt(12) = 3.46: four 16-bit
    /// uniform numbers from one draw, because every sample of every sensor asks for one.
    pub(crate) fn noise(&mut self) -> f64 {
        const SQRT_3: f64 = 1.732_050_807_568_877_2;
        let bits = self.0.next_u64();
        let sum: u64 = (0..4).map(|k| (bits >> (16 * k)) & 0xFFFF).sum();
        (sum as f64 * (1.0 / 32_767.5) - 4.0) * (0.5 * SQRT_3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance and largest magnitude of `n` draws.
    fn moments(n: usize, mut draw: impl FnMut() -> f64) -> (f64, f64, f64) {
        let values: Vec<f64> = (0..n).map(|_| draw()).collect();
        let mean = values.iter().sum::<f64>() / n as f64;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n as f64;
        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        (mean, variance, largest)
    }

    #[test]
    fn noise_is_standard() {
        let mut r = Random::new(3, 0);
        let (mean, variance, largest) = moments(200_000, || r.noise());
        assert!(mean.abs() < 0.01, "{mean}");
        assert!((variance - 1.0).abs() < 0.02, "{variance}");
        assert!(largest <= 12.0f64.sqrt() + 1e-9, "{largest}");
    }

    #[test]
    fn truncated_normal_stops_at_three() {
        let mut r = Random::new(4, 0);
        let (mean, variance, largest) = moments(50_000, || r.truncated_normal());
        assert!(mean.abs() < 0.02, "{mean}");
        // The normal law cut at 3 has variance 0.973.
        assert!((variance - 0.975).abs() < 0.03, "{variance}");
        assert!(largest <= 3.0 && largest > 2.7, "{largest}");
    }

    #[test]
    fn streams_differ_and_repeat() {
        let draw = |seed, stream| Random::new(seed, stream).unit();
        assert_eq!(draw(1, 0), draw(1, 0));
        assert_ne!(draw(1, 0), draw(1, 1));
        assert_ne!(draw(1, 0), draw(2, 0));
    }
}
