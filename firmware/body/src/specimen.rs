//! Parameters of a specimen: nominal values with source and spread, drawn by a seed.
//!
//! | parameter | nominal | standard deviation | source |
//! | --- | --- | --- | --- |
//! | loop stiffness | 0.3 of range | 20 % | assumed: a loop of 7 % of range, of the 5-15 % that elastomers are said to have |
//! | creep | 5 % | 20 % | assumed: 4.5 % from 1 s to 10 min |
//! | damping | 18 % | 20 % | assumed: loss factor of 0.04-0.05 at 0.3-5 Hz |
//! | softening | 12 % | 20 % | phenomenon: Case et al. 2015, doi:10.1089/soro.2015.0002 (the first cycle of silicones differs); size assumed |
//! | place of a tube on its plate | as designed | 0.3 mm | assumed: a printed connector |
//! | angle of a tube on its plate | as designed | 0.5 deg | assumed: a cast end in a printed seat |
//! | length of a connector | as designed | 0.3 mm | assumed |
//! | direction of the base | as designed | 0.3 deg | assumed: a bracket set with a spirit level |
//! | friction of obstacles | 0.5 | none | assumed: cast silicone or a printed part on a table; in `contact.rs` |

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use softlimb_numerics::Random;

use crate::memory::MemoryParameters;

/// Streams of a seed: one a channel's memory from the first, one for the assembly.
const MEMORY: u64 = 1 << 32;
const ASSEMBLY: u64 = 1 << 33;
/// Draws beyond this many standard deviations are drawn again.
const LARGEST: f64 = 3.0;
/// Relative standard deviation of every strength of a memory.
const MEMORY_SPREAD: f64 = 0.2;

impl Default for MemoryParameters {
    fn default() -> Self {
        Self { loop_stiffness: 0.3, creep: 0.05, damping: 0.18, softening: 0.12 }
    }
}

impl MemoryParameters {
    /// Those of the actuator of a channel of the specimen `seed`.
    pub fn drawn(seed: u64, channel: usize) -> Self {
        let mut random = Random::new(seed, MEMORY + channel as u64);
        let nominal = Self::default();
        let mut around = |value: f64| value * (1.0 + MEMORY_SPREAD * normal(&mut random));
        Self {
            loop_stiffness: around(nominal.loop_stiffness),
            creep: around(nominal.creep),
            damping: around(nominal.damping),
            softening: around(nominal.softening),
        }
    }
}

/// Standard deviations of what is fitted together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Each coordinate of a tube's end on its plate, m.
    pub place_m: f64,
    /// Each angle of a tube's end on its plate, rad.
    pub angle_rad: f64,
    /// Length of a connector, m.
    pub length_m: f64,
    /// Each angle of the base, rad.
    pub base_rad: f64,
}

impl Tolerance {
    /// As designed.
    pub const NONE: Self = Self { place_m: 0.0, angle_rad: 0.0, length_m: 0.0, base_rad: 0.0 };
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { place_m: 0.3e-3, angle_rad: 0.5_f64.to_radians(), length_m: 0.3e-3, base_rad: 0.3_f64.to_radians() }
    }
}

/// Draws the deviations of one limb's assembly, in the order of the calls.
#[derive(Clone, Debug)]
pub struct Assembly {
    tolerance: Tolerance,
    random: Random,
}

impl Assembly {
    /// The assembly of the specimen `seed`.
    pub fn new(seed: u64, tolerance: Tolerance) -> Self {
        Self { tolerance, random: Random::new(seed, ASSEMBLY) }
    }

    /// The base, about where it is designed.
    pub fn base(&mut self) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::identity(), self.turn(self.tolerance.base_rad))
    }

    /// The end of a tube, about its place.
    pub fn seat(&mut self) -> Isometry3<f64> {
        let [x, y] = [(); 2].map(|()| self.tolerance.place_m * normal(&mut self.random));
        Isometry3::from_parts(Translation3::new(x, y, 0.0), self.turn(self.tolerance.angle_rad))
    }

    /// By how much a connector is too long, m.
    pub fn length_m(&mut self) -> f64 {
        self.tolerance.length_m * normal(&mut self.random)
    }

    fn turn(&mut self, deviation_rad: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::new(Vector3::from_fn(|_, _| deviation_rad * normal(&mut self.random)))
    }
}

/// Normal, and drawn again beyond three standard deviations.
fn normal(random: &mut Random) -> f64 {
    loop {
        let value = random.normal();
        if value.abs() <= LARGEST {
            return value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn same_seed_gives_the_same_specimen_and_another_another() {
        assert_eq!(MemoryParameters::drawn(7, 2), MemoryParameters::drawn(7, 2));
        assert_ne!(MemoryParameters::drawn(7, 2), MemoryParameters::drawn(7, 3));
        assert_ne!(MemoryParameters::drawn(7, 2), MemoryParameters::drawn(8, 2));
        let seats = |seed| {
            let mut assembly = Assembly::new(seed, Tolerance::default());
            [assembly.seat(), assembly.seat(), assembly.base()]
        };
        assert_eq!(seats(3), seats(3));
        assert_ne!(seats(3), seats(4));
        assert_ne!(seats(3)[0], seats(3)[1]);
    }

    #[test]
    fn draws_scatter_as_stated() {
        let draws: Vec<f64> =
            (0..4000).map(|channel| MemoryParameters::drawn(1, channel).loop_stiffness / 0.3 - 1.0).collect();
        let deviation = (draws.iter().map(|x| x * x).sum::<f64>() / draws.len() as f64).sqrt();
        // A normal distribution cut at 3 has 0.987 of its deviation; 4000 draws have a standard error of 1.1 %.
        assert!((deviation / (0.2 * 0.987) - 1.0).abs() < 0.05, "{deviation}");
        assert!(draws.iter().all(|x| x.abs() <= 0.6));
    }

    #[test]
    fn assembly_without_tolerance_is_as_designed() {
        let mut assembly = Assembly::new(1, Tolerance::NONE);
        assert_eq!(
            (assembly.seat(), assembly.base(), assembly.length_m()),
            (Isometry3::identity(), Isometry3::identity(), 0.0)
        );
    }
}
