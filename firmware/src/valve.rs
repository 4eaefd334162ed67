//! A pair of normally closed valves as the coils see it: delays, smallest pulse, and never both at once.

/// Direction of a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Air from the supply.
    Fill,
    /// Air to the atmosphere.
    Vent,
}

/// Coil times of one channel in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ValvePulse {
    /// Time from the start of the tick for which the fill coil is energized, us, `0..=1000`.
    pub fill_us: u16,
    /// Time from the start of the tick for which the vent coil is energized, us, `0..=1000`.
    pub vent_us: u16,
}

impl ValvePulse {
    /// Both coils off: the pressure is kept.
    pub const CLOSED: Self = Self { fill_us: 0, vent_us: 0 };

    /// The vent coil on for the whole tick.
    pub const VENTING: Self = Self { fill_us: 0, vent_us: TICK_US as u16 };

    fn new(direction: Direction, coil_us: u16) -> Self {
        match direction {
            Direction::Fill => Self { fill_us: coil_us, vent_us: 0 },
            Direction::Vent => Self { fill_us: 0, vent_us: coil_us },
        }
    }
}

/// Length of one tick, us.
pub const TICK_US: u32 = 1_000;

/// Delays of a valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValveTiming {
    /// From coil on to valve open, us.
    pub on_delay_us: u32,
    /// From coil off to valve closed, us.
    pub off_delay_us: u32,
}

impl ValveTiming {
    /// Shortest time a valve that was closed can be made to stay open, us, when its coil is energized for `margin_us` beyond the
    /// opening delay.
    ///
    /// A coil switched off before the opening delay has passed opens nothing; once the valve opens it stays open for the closing
    /// delay.
    pub fn shortest_open_us(&self, margin_us: u32) -> u32 {
        self.off_delay_us + margin_us
    }

    /// Coil time that makes a closed valve open for `open_us`, us, or for the shortest time if that is longer.
    pub fn coil_us(&self, open_us: u32, margin_us: u32) -> u32 {
        open_us.max(self.shortest_open_us(margin_us)) - self.off_delay_us + self.on_delay_us
    }

    /// Coil time after which a valve that is open closes in `open_us`, us; 0 when it cannot close as early.
    pub fn coil_rest_us(&self, open_us: u32) -> u32 {
        open_us.saturating_sub(self.off_delay_us)
    }
}

/// The coils of one channel over time. At most one of the two is energized: the type holds one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValvePair {
    energized: Option<(Direction, u64)>,
    /// Pulse that follows at once, and its coil time, us.
    next: Option<(Direction, u32)>,
    closed_at_us: u64,
}

impl ValvePair {
    /// Both coils off since the beginning of time.
    pub const fn new() -> Self {
        Self { energized: None, next: None, closed_at_us: 0 }
    }

    /// Energizes one coil from `now_us` for `coil_us`, switching the other off.
    pub fn pulse(&mut self, direction: Direction, now_us: u64, coil_us: u32) {
        self.energized = Some((direction, now_us.saturating_add(u64::from(coil_us))));
        self.next = None;
    }

    /// Energizes one coil from `now_us`, and the other in the tick after that; coil times in us.
    pub fn pair(&mut self, now_us: u64, first: (Direction, u32), then: (Direction, u32)) {
        self.pulse(first.0, now_us, first.1);
        self.next = Some(then);
    }

    /// Switches both coils off.
    pub fn close(&mut self, now_us: u64) {
        self.next = None;
        if self.energized.take().is_some() {
            self.closed_at_us = now_us;
        }
    }

    /// The coil that is energized at `now_us`.
    pub fn direction_at(&self, now_us: u64) -> Option<Direction> {
        self.energized.filter(|&(_, until)| until > now_us).map(|(direction, _)| direction)
    }

    /// When the last coil was or will be switched off, us; of a pair of pulses, when the first one's is.
    pub fn closed_at_us(&self) -> u64 {
        self.energized.map_or(self.closed_at_us, |(_, until)| until)
    }

    /// Coil times for the tick that begins at `now_us`.
    pub fn tick(&mut self, now_us: u64) -> ValvePulse {
        let Some((direction, until)) = self.energized else {
            return ValvePulse::CLOSED;
        };
        let left_us = until.saturating_sub(now_us);
        if left_us == 0 {
            self.energized = None;
            self.closed_at_us = until;
            if let Some((direction, coil_us)) = self.next.take() {
                self.pulse(direction, now_us, coil_us);
                return self.tick(now_us);
            }
        }
        let coil_us = left_us.min(u64::from(TICK_US));
        ValvePulse::new(direction, u16::try_from(coil_us).unwrap_or(0))
    }
}

impl Default for ValvePair {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMING: ValveTiming = ValveTiming { on_delay_us: 3_500, off_delay_us: 2_000 };

    #[test]
    fn coil_time_makes_up_for_the_delays() {
        assert_eq!(TIMING.coil_us(8_000, 500), 9_500);
        assert_eq!(TIMING.coil_rest_us(8_000), 6_000);
    }

    #[test]
    fn closed_valve_opens_for_the_shortest_time_or_not_at_all() {
        // Below 4 ms of coil time it might not open: 3.5 ms delay and 0.5 ms margin.
        assert_eq!(TIMING.coil_us(1, 500), 4_000);
        assert_eq!(TIMING.shortest_open_us(500), 2_500);
        assert_eq!(TIMING.coil_rest_us(1), 0);
    }

    #[test]
    fn pulse_is_cut_into_ticks_and_adds_up() {
        let mut pair = ValvePair::new();
        pair.pulse(Direction::Vent, 20_000, 2_400);
        let ticks: Vec<_> = (20..25).map(|t| pair.tick(t * 1_000)).collect();
        assert_eq!(ticks.iter().map(|p| p.vent_us).collect::<Vec<_>>(), [1_000, 1_000, 400, 0, 0]);
        assert!(ticks.iter().all(|p| p.fill_us == 0));
        assert_eq!(pair.closed_at_us(), 22_400);
    }

    #[test]
    fn pair_energizes_one_coil_after_the_other_and_ends_with_the_second() {
        let mut pair = ValvePair::new();
        pair.pair(0, (Direction::Fill, 1_300), (Direction::Vent, 1_600));
        let ticks: Vec<_> = (0..6).map(|t| pair.tick(t * 1_000)).collect();
        let (fill, vent): (Vec<_>, Vec<_>) = ticks.iter().map(|p| (p.fill_us, p.vent_us)).unzip();
        assert_eq!((fill, vent), (vec![1_000, 300, 0, 0, 0, 0], vec![0, 0, 1_000, 600, 0, 0]));
        assert_eq!(pair.closed_at_us(), 3_600);
        pair.pair(9_000, (Direction::Fill, 1_300), (Direction::Vent, 1_600));
        pair.close(9_500);
        assert_eq!(pair.tick(10_000), ValvePulse::CLOSED, "both are called off");
    }

    #[test]
    fn new_direction_switches_the_other_coil_off() {
        let mut pair = ValvePair::new();
        pair.pulse(Direction::Fill, 0, 50_000);
        assert_eq!(pair.tick(0), ValvePulse { fill_us: 1_000, vent_us: 0 });
        pair.pulse(Direction::Vent, 1_000, 5_000);
        assert_eq!(pair.tick(1_000), ValvePulse { fill_us: 0, vent_us: 1_000 });
        pair.close(2_000);
        assert_eq!(pair.tick(2_000), ValvePulse::CLOSED);
        assert_eq!(pair.closed_at_us(), 2_000);
    }
}
