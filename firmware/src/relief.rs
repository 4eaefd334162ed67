//! Letting the air out: a ramp down, then an open vent.

/// Gauge pressure below which the vent opens for good, Pa.
const OPEN_BELOW_PA: f32 = 3_000.0;

/// Gauge pressure below which a chamber counts as empty, Pa.
const EMPTY_BELOW_PA: f32 = 2_000.0;

/// Time for which the vent stays open at least, us, and at most when the sensor never reads an empty chamber.
const OPEN_MIN_US: u64 = 500_000;
pub(crate) const OPEN_MAX_US: u64 = 5_000_000;

/// Longest time of the ramp beyond its slope before the vent opens anyway, us.
const LAG_MAX_US: u64 = 2_000_000;

/// The pressure that falls linearly from the one at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ramp {
    start_us: u64,
    start_pa: f32,
    slope_pa_per_s: f32,
    open: bool,
}

impl Ramp {
    /// Gauge pressure at a time, Pa.
    pub(crate) fn at(&self, time_us: u64) -> f32 {
        let elapsed_s = time_us.saturating_sub(self.start_us) as f32 * 1e-6;
        (self.start_pa - self.slope_pa_per_s * elapsed_s).max(0.0)
    }

    /// Whether the vent is open for good.
    pub(crate) fn is_open(&self) -> bool {
        self.open
    }
}

/// State of one channel's relief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relief {
    ramp: Option<Ramp>,
    open_since_us: Option<u64>,
    empty: bool,
}

impl Relief {
    /// Not begun.
    pub(crate) const fn new() -> Self {
        Self { ramp: None, open_since_us: None, empty: false }
    }

    /// The ramp at this tick; begins it at the present pressure where it was not begun.
    pub(crate) fn advance(&mut self, now_us: u64, pressure_pa: f32, trusted: bool, slope_pa_per_s: f32) -> Ramp {
        let begun = Ramp { start_us: now_us, start_pa: pressure_pa, slope_pa_per_s, open: false };
        let mut ramp = self.ramp.unwrap_or(begun);
        let at_end = ramp.at(now_us) <= OPEN_BELOW_PA;
        let overdue = at_end && ramp.at(now_us.saturating_sub(LAG_MAX_US)) <= 0.0;
        ramp.open |= (at_end && (pressure_pa < OPEN_BELOW_PA || !trusted)) || overdue;
        if ramp.open {
            self.open_since_us.get_or_insert(now_us);
        }
        self.empty = trusted && pressure_pa < EMPTY_BELOW_PA;
        self.ramp = Some(ramp);
        ramp
    }

    /// Whether the vent is open for good.
    pub(crate) fn is_open(&self) -> bool {
        self.open_since_us.is_some()
    }

    /// Whether the vent has been open long enough: until the chamber is empty, or for the longest time.
    pub(crate) fn is_done(&self, now_us: u64) -> bool {
        let open_us = self.open_since_us.map_or(0, |since| now_us.saturating_sub(since));
        (self.empty && open_us >= OPEN_MIN_US) || open_us >= OPEN_MAX_US
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramp_falls_from_the_present_pressure_and_ends_in_an_open_vent() {
        let mut relief = Relief::new();
        let ramp = relief.advance(1_000_000, 50_000.0, true, 20_000.0);
        assert_eq!(ramp.at(2_000_000), 30_000.0);
        assert_eq!(ramp.at(9_000_000), 0.0);
        assert!(!relief.advance(2_000_000, 30_000.0, true, 20_000.0).is_open());
        assert!(!relief.advance(3_400_000, 6_000.0, true, 20_000.0).is_open(), "the chamber lags");
        assert!(relief.advance(3_500_000, 2_500.0, true, 20_000.0).is_open());
        assert!(!relief.is_done(3_900_000));
        relief.advance(4_000_000, 1_500.0, true, 20_000.0);
        assert!(relief.is_done(4_000_000));
    }

    #[test]
    fn chamber_that_never_empties_is_left_open_for_the_longest_time() {
        let mut relief = Relief::new();
        relief.advance(0, 20_000.0, true, 20_000.0);
        assert!(!relief.advance(2_900_000, 20_000.0, true, 20_000.0).is_open());
        assert!(relief.advance(3_000_000, 20_000.0, true, 20_000.0).is_open(), "two seconds behind the ramp");
        assert!(!relief.is_done(7_999_999));
        assert!(relief.is_done(8_000_000));
    }

    #[test]
    fn without_a_sensor_the_vent_opens_when_the_ramp_ends() {
        let mut relief = Relief::new();
        relief.advance(0, 20_000.0, false, 20_000.0);
        assert!(!relief.advance(800_000, 20_000.0, false, 20_000.0).is_open());
        assert!(relief.advance(900_000, 20_000.0, false, 20_000.0).is_open());
    }
}
