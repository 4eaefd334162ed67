//! Seeded random numbers, the same on every machine and in every version.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Uniform numbers from a seed.
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream of numbers that belongs to a seed; streams of one seed are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// In `0..1`.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Of nearly normal distribution: mean zero, standard deviation one.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// `width` uniform numbers.
    pub fn place(&mut self, width: usize) -> Vec<f64> {
        (0..width).map(|_| self.uniform()).collect()
    }
}
