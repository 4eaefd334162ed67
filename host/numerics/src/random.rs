//! Seeded random numbers, the same on every machine and in every version.

use nalgebra::ComplexField;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A stream of random numbers.
#[derive(Clone, Debug)]
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
        unit(self.0.next_u64())
    }

    /// Of the normal distribution with mean zero and standard deviation one: Marsaglia's polar method.
    pub fn normal(&mut self) -> f64 {
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                // The logarithm of `libm`, which has the same digits everywhere.
                return x * (-2.0 * ComplexField::ln(square) / square).sqrt();
            }
        }
    }

    /// An index below `count`; 0 where that is 0.
    pub fn index(&mut self, count: usize) -> usize {
        (self.0.next_u64() % (count as u64).max(1)) as usize
    }

    /// A point of the unit box with `width` axes.
    pub fn point(&mut self, width: usize) -> Vec<f64> {
        (0..width).map(|_| self.uniform()).collect()
    }
}

/// A number in `0..1` by seed and index, without those before it: the mixing function of SplitMix64.
pub fn uniform_at(seed: u64, index: u64) -> f64 {
    let mut z = seed.wrapping_add(index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    unit(z ^ (z >> 31))
}

fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares of the normal distribution by its printed table, and moments; 1e6 draws have standard errors below 5e-4 and 4e-3.
    #[test]
    fn normal_numbers_have_the_shares_of_the_printed_table() {
        let mut random = Random::new(1, 2);
        let draws: Vec<f64> = (0..1_000_000).map(|_| random.normal()).collect();
        let share = |within: f64| draws.iter().filter(|x| x.abs() < within).count() as f64 / draws.len() as f64;
        for (within, printed) in
            [(0.5, 0.382_925), (1.0, 0.682_689), (2.0, 0.954_500), (3.0, 0.997_300), (4.0, 0.999_937)]
        {
            assert!((share(within) - printed).abs() < 2e-3, "{within}: {}", share(within));
        }
        let moment = |power: i32| draws.iter().map(|x| x.powi(power)).sum::<f64>() / draws.len() as f64;
        assert!(moment(1).abs() < 4e-3 && (moment(2) - 1.0).abs() < 6e-3, "{} {}", moment(1), moment(2));
        assert!(moment(3).abs() < 2e-2 && (moment(4) - 3.0).abs() < 4e-2, "{} {}", moment(3), moment(4));
    }

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |seed, stream| Random::new(seed, stream).point(4);
        assert_eq!(draw(1, 0), draw(1, 0));
        assert!(draw(1, 0) != draw(1, 1) && draw(1, 0) != draw(2, 0));
        assert!((0..1000).all(|seed| Random::new(seed, 0).index(3) < 3) && Random::new(1, 0).index(0) == 0);
        assert!((0..1000).all(|index| (0.0..1.0).contains(&uniform_at(7, index))));
        assert!(uniform_at(7, 1) != uniform_at(7, 2) && uniform_at(7, 1) != uniform_at(8, 1));
    }
}
