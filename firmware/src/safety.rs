//! Watching: conditions that have to last, and the regularity of the tick.

use crate::valve::TICK_US;

/// Ticks for which the supply has to be low before it is a fault while running.
pub(crate) const SUPPLY_LOW_TICKS: u16 = 100;

/// Ticks for which the supply has to be high before it is a fault.
pub(crate) const SUPPLY_HIGH_TICKS: u16 = 10;

/// Ticks for which the voltage of the valves' supply has to be low before it is a fault: longer than a dip that coils bridge, and shorter than
/// the time in which chambers show that their valves do not follow.
pub(crate) const VALVE_SUPPLY_LOW_TICKS: u16 = 5;

/// Window in which a second late tick is a fault, us.
const LATE_WINDOW_US: u64 = 1_000_000;

/// Counts the ticks for which a condition lasts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Lasting {
    ticks: u16,
}

impl Lasting {
    pub(crate) const fn new() -> Self {
        Self { ticks: 0 }
    }

    /// True once the condition has held for `limit` ticks in a row.
    pub(crate) fn holds(&mut self, condition: bool, limit: u16) -> bool {
        self.ticks = if condition { self.ticks.saturating_add(1).min(limit) } else { 0 };
        condition && self.ticks >= limit
    }
}

/// Watches the distance between ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TickWatch {
    last_us: Option<u64>,
    last_late_us: Option<u64>,
    late: u16,
}

impl TickWatch {
    pub(crate) const fn new() -> Self {
        Self { last_us: None, last_late_us: None, late: 0 }
    }

    /// Whether no tick has come yet.
    pub(crate) fn is_first(&self) -> bool {
        self.last_us.is_none()
    }

    /// Takes the time of a tick; the distance to the last one, us, if it is the second late tick within one second.
    pub(crate) fn tick(&mut self, now_us: u64) -> Option<u64> {
        let last_us = self.last_us.replace(now_us)?;
        let distance_us = now_us.saturating_sub(last_us);
        if distance_us <= u64::from(TICK_US + TICK_US / 2) {
            return None;
        }
        self.late = self.late.saturating_add(1);
        let before = self.last_late_us.replace(now_us)?;
        (now_us.saturating_sub(before) <= LATE_WINDOW_US).then_some(distance_us)
    }

    /// Ticks that came late.
    pub(crate) fn late(&self) -> u16 {
        self.late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn condition_has_to_hold_in_a_row() {
        let mut low = Lasting::new();
        let held: Vec<_> = [true, true, false, true, true, true, true].map(|c| low.holds(c, 3)).into();
        assert_eq!(held, [false, false, false, false, false, true, true]);
    }

    #[test]
    fn two_late_ticks_within_a_second_are_reported() {
        let mut watch = TickWatch::new();
        for now_us in [0, 1_000, 2_500] {
            assert_eq!(watch.tick(now_us), None);
        }
        assert_eq!(watch.late(), 0, "half a tick of jitter is not late");
        assert_eq!(watch.tick(4_001), None);
        assert_eq!(watch.tick(7_001), Some(3_000));
        assert_eq!(watch.late(), 2);
        assert_eq!(watch.tick(2_000_000), None, "the last one was long ago");
    }
}
