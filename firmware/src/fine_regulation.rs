//! Fine regulation while the reference rests.
//!
//! A valve that opens stays open for its closing delay at least, so that the pressure cannot be set finer than by a shortest pulse, and one
//! sample has the sensor's noise. While the reference rests there is time for both: readings are averaged, and an error smaller than a
//! shortest pulse is taken away by two pulses, one up and at once a measured one down, whose effects differ by it. What valves scatter
//! decides where such a pair ends; it is repeated until the error is small enough. At a reference that stands still, each pair makes a little
//! more error good enough: a leak does not keep the valves busy.

use crate::reference::Reference;
use crate::valve::Direction;

/// Readings that make a mean worth deciding on.
const ENOUGH: u16 = 8;
/// Readings after which old ones are forgotten.
const MEMORY: u16 = 48;
/// Error up to which fine regulation acts, Pa: a shortest pulse or two.
const NEAR_PA: f32 = 1_000.0;
/// Effect of a shortest filling pulse up to which fine regulation acts, Pa: a pair of pulses stays within the 1 kPa of a settled pressure.
const FINE_PA: f32 = 600.0;
/// Distance of a reading from the mean at which the pressure has moved, Pa: beyond the noise.
const MOVED_PA: f32 = 500.0;
/// Error that is small enough at first, Pa: half a step of a converter of 12 bits and 2 bar. Each pair widens it by a factor.
const BAND_PA: f32 = 33.0;
const BAND_GROWTH: f32 = 1.4;
/// Pairs after which the band grows no more.
const PAIRS_MAX: u8 = 16;
/// Control periods after which a pair is forgotten.
const FORGET: u8 = 250;
/// By how much more the error may be once it was small enough.
const LEFT: f32 = 2.0;
/// Change of the reference over a control period up to which it stands still, Pa.
const STILL_PA: f32 = 2.0;
/// Share of a shortest filling pulse that a pair scatters by.
const SCATTER: f32 = 0.1;
/// Share of an innovation that the bias takes.
const BIAS_RATE: f32 = 0.3;
/// Share of a pulse's effect that is missing where it did not open its valve.
const MISSED: f32 = 0.75;
/// Control periods by which a pair runs ahead of a reference that slides.
const AHEAD: f32 = 2.5;

/// A pair of pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    /// Pressure at its begin, Pa.
    pub(crate) before_pa: f32,
    /// Desired change, Pa.
    pub(crate) desired_pa: f32,
    /// Effects of its pulses, Pa, > 0.
    pub(crate) up_pa: f32,
    pub(crate) down_pa: f32,
}

/// Fine regulation of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FineRegulation {
    possible: bool,
    reading_pa: f32,
    sum_pa: f32,
    count: u16,
    pairs: u8,
    age: u8,
    converged: bool,
    /// Effect of a pair beyond its desired change, Pa.
    bias_pa: f32,
    desired: Option<Pair>,
}

impl FineRegulation {
    /// Nothing read.
    pub(crate) const fn new() -> Self {
        Self {
            possible: false,
            reading_pa: 0.0,
            sum_pa: 0.0,
            count: 0,
            pairs: 0,
            age: 0,
            converged: false,
            bias_pa: 0.0,
            desired: None,
        }
    }

    /// Takes a reading of a settled line, or forgets all of them where the line moves.
    pub(crate) fn sample(&mut self, reading_pa: Option<f32>) {
        let Some(reading_pa) = reading_pa else {
            (self.sum_pa, self.count) = (0.0, 0);
            return;
        };
        self.reading_pa = reading_pa;
        if (self.sum_pa - f32::from(self.count) * reading_pa).abs() > f32::from(self.count) * MOVED_PA {
            (self.sum_pa, self.count) = (0.0, 0);
        }
        if self.count >= MEMORY {
            self.sum_pa *= 0.5;
            self.count /= 2;
        }
        self.sum_pa += reading_pa;
        self.count += 1;
    }

    /// The mean reading since the line settled, Pa, once it is worth deciding on.
    pub(crate) fn mean_pa(&self) -> Option<f32> {
        (self.count >= ENOUGH).then(|| self.sum_pa / f32::from(self.count))
    }

    /// Takes the effect of the shortest filling pulse, Pa. If it leaves the band of a settled pressure, fine regulation stays off.
    pub(crate) fn note_shortest(&mut self, up_pa: f32) {
        self.possible = up_pa <= FINE_PA;
    }

    /// Whether the pressure is so near to a reference at rest that fine regulation acts.
    pub(crate) fn is_near(&self, reference: &Reference, now_us: u64) -> bool {
        self.possible && reference.is_resting() && (self.reading_pa - reference.at(now_us)).abs() <= NEAR_PA
    }

    /// The reference moves: the next rest begins afresh.
    pub(crate) fn restart(&mut self) {
        (self.pairs, self.converged, self.desired) = (0, false, None);
    }

    /// Whether a pair has begun from which nothing was learned yet.
    pub(crate) fn is_pairing(&self) -> bool {
        self.desired.is_some()
    }

    /// Learns from the last pair; the direction whose pulse cannot have opened its valve.
    pub(crate) fn learn(&mut self, pressure_pa: f32) -> Option<Direction> {
        let pair = self.desired.take()?;
        let innovation_pa = pressure_pa - pair.before_pa - pair.desired_pa;
        if innovation_pa > MISSED * pair.down_pa {
            return Some(Direction::Vent);
        }
        if innovation_pa < -MISSED * pair.up_pa {
            return Some(Direction::Fill);
        }
        self.bias_pa += BIAS_RATE * (innovation_pa - self.bias_pa);
        None
    }

    /// Error that is small enough, Pa; `up_pa` is the effect of the shortest filling pulse, Pa.
    pub(crate) fn band_pa(&self, up_pa: f32, reference: &Reference) -> f32 {
        if (reference.end_pa - reference.start_pa).abs() <= STILL_PA {
            (0..self.pairs).fold(BAND_PA, |band_pa, _| BAND_GROWTH * band_pa)
        } else {
            BAND_PA.max(SCATTER * up_pa)
        }
    }

    /// Whether an error, Pa, is left alone: within the band, and below `single_pa`, from which on a single pulse makes it smaller.
    pub(crate) fn leaves(&mut self, error_pa: f32, band_pa: f32, single_pa: f32) -> bool {
        self.age = self.age.wrapping_add(1);
        if self.age >= FORGET {
            (self.age, self.pairs) = (0, self.pairs.saturating_sub(1));
        }
        let allowed_pa = if self.converged { LEFT * band_pa } else { band_pa };
        self.converged = error_pa.abs() <= allowed_pa.min(single_pa);
        self.converged
    }

    /// Change to request of a pair, Pa, that removes an error, Pa.
    pub(crate) fn requested_pa(&self, error_pa: f32, reference: &Reference) -> f32 {
        let ahead_pa = (AHEAD * (reference.end_pa - reference.start_pa)).clamp(-BAND_PA, BAND_PA);
        error_pa + ahead_pa - self.bias_pa
    }

    /// A pair begins.
    pub(crate) fn begin(&mut self, pair: Pair) {
        self.pairs = (self.pairs + 1).min(PAIRS_MAX);
        self.desired = Some(pair);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(rate_pa: f32) -> Reference {
        Reference { start_us: 0, start_pa: 50e3, period_us: 20_000, end_pa: 50e3 + rate_pa }
    }

    #[test]
    fn readings_are_averaged_until_the_line_or_the_pressure_moves() {
        let mut fine = FineRegulation::new();
        for index in 0..7 {
            fine.sample(Some(50e3 + if index % 2 == 0 { 60.0 } else { -60.0 }));
        }
        assert_eq!(fine.mean_pa(), None, "seven are not enough");
        fine.sample(Some(50e3 - 60.0));
        assert_eq!(fine.mean_pa(), Some(50e3));
        fine.sample(Some(51e3));
        assert_eq!(fine.mean_pa(), None, "1 kPa is no noise");
        (0..8).for_each(|_| fine.sample(Some(51e3)));
        assert_eq!(fine.mean_pa(), Some(51e3));
        fine.sample(None);
        assert_eq!(fine.mean_pa(), None);
    }

    fn leaves(fine: &mut FineRegulation, error_pa: f32, rate_pa: f32) -> bool {
        let band_pa = fine.band_pa(500.0, &reference(rate_pa));
        fine.leaves(error_pa, band_pa, 275.0)
    }

    #[test]
    fn band_doubles_once_the_error_is_small_enough() {
        let mut fine = FineRegulation::new();
        assert!(!leaves(&mut fine, 60.0, 0.0));
        assert!(leaves(&mut fine, -30.0, 0.0));
        assert!(leaves(&mut fine, 60.0, 0.0));
        assert!(!leaves(&mut fine, 70.0, 0.0));
        assert!(!leaves(&mut fine, 60.0, 0.0), "it has to become good again");
    }

    #[test]
    fn pair_after_pair_more_is_good_enough_at_a_reference_that_stands_still() {
        let mut fine = FineRegulation::new();
        let pair = Pair { before_pa: 50e3, desired_pa: 100.0, up_pa: 500.0, down_pa: 400.0 };
        for _ in 0..4 {
            assert!(!leaves(&mut fine, 120.0, 0.0));
            fine.begin(pair);
        }
        assert!(leaves(&mut fine, 120.0, 0.0), "33 Pa times 1.4 to the fourth is 127 Pa");
        assert!(!leaves(&mut fine, 120.0, 10.0), "one that slides is followed");
        (0..20).for_each(|_| fine.begin(pair));
        assert!(leaves(&mut fine, -270.0, 0.0));
        assert!(!leaves(&mut fine, -280.0, 0.0), "a single pulse makes it smaller, however many pairs there were");
    }

    #[test]
    fn pair_teaches_its_bias_or_which_valve_stayed_shut() {
        let mut fine = FineRegulation::new();
        let pair = Pair { before_pa: 50e3, desired_pa: 100.0, up_pa: 500.0, down_pa: 400.0 };
        fine.begin(pair);
        assert_eq!(fine.learn(50e3 + 150.0), None);
        assert!((fine.requested_pa(100.0, &reference(0.0)) - 85.0).abs() < 1e-3, "a third of 50 Pa is expected again");
        fine.begin(pair);
        assert_eq!(fine.learn(50e3 + 500.0), Some(Direction::Vent));
        fine.begin(pair);
        assert_eq!(fine.learn(50e3 - 400.0), Some(Direction::Fill), "500 Pa less than desired");
        assert_eq!(fine.learn(50e3), None, "nothing is learned twice");
    }
}
