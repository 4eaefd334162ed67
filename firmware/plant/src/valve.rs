//! A solenoid valve that is normally closed: coil edges in, poppet state out.

use crate::random::Random;

const NEVER: u64 = u64::MAX;

/// Shares of the nominal voltage: the least that opens a valve, and the least that keeps it open. An armature that has closed its gap needs
/// about half the current.
const PULL_IN: f64 = 0.7;
const HOLD_IN: f64 = 0.35;

/// Effect of the valves' supply on energized coils.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coils {
    /// They open their valves.
    PullIn,
    /// They keep open what is open.
    HoldIn,
    /// They drop out.
    DropOut,
}

impl Coils {
    /// At a share of their nominal voltage.
    pub(crate) fn at(share: f64) -> Self {
        match share {
            _ if share >= PULL_IN => Self::PullIn,
            _ if share >= HOLD_IN => Self::HoldIn,
            _ => Self::DropOut,
        }
    }

    /// Whether an energized coil acts on a valve that is open or not.
    pub(crate) fn act(self, is_open: bool) -> bool {
        match self {
            Self::PullIn => true,
            Self::HoldIn => is_open,
            Self::DropOut => false,
        }
    }
}

/// One on/off valve. The poppet follows the coil after a delay; a coil edge inside the delay
/// cancels the movement that was under way, so a pulse shorter than the delay does nothing.
#[derive(Clone, Debug)]
pub(crate) struct Valve {
    on_delay_us: f64,
    off_delay_us: f64,
    jitter_us: f64,
    coil: bool,
    open: bool,
    due_us: u64,
}

impl Valve {
    /// A closed valve with these delays; each movement varies by up to `jitter_us` either way.
    pub(crate) fn new(on_delay_us: f64, off_delay_us: f64, jitter_us: f64) -> Self {
        Self { on_delay_us, off_delay_us, jitter_us, coil: false, open: false, due_us: NEVER }
    }

    /// Brings the valve to the time `now_us`: a poppet due by now moves, then the coil is set,
    /// and a valve without delay follows at once.
    pub(crate) fn set_coil(&mut self, now_us: u64, on: bool, random: &mut Random) {
        self.advance(now_us);
        if on != self.coil {
            self.coil = on;
            self.due_us = if on == self.open { NEVER } else { now_us.saturating_add(self.delay_us(random)) };
            self.advance(now_us);
        }
    }

    fn delay_us(&self, random: &mut Random) -> u64 {
        let nominal = if self.coil { self.on_delay_us } else { self.off_delay_us };
        // A float casts to an integer with saturation: a negative delay is none.
        (nominal + self.jitter_us * random.symmetric()).round() as u64
    }

    fn advance(&mut self, now_us: u64) {
        if self.due_us <= now_us {
            self.open = self.coil;
            self.due_us = NEVER;
        }
    }

    /// When the poppet will move next, us; `u64::MAX` when it will not.
    pub(crate) fn due_us(&self) -> u64 {
        self.due_us
    }

    pub(crate) fn is_open(&self) -> bool {
        self.open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applies (time, coil) edges and returns the times at which the poppet moved.
    fn movements(valve: &mut Valve, edges: &[(u64, bool)]) -> Vec<(u64, bool)> {
        let mut random = Random::new(1, 0);
        let mut moved = Vec::new();
        for now in 0..30_000 {
            let before = valve.is_open();
            let on = edges.iter().rfind(|e| e.0 <= now).is_some_and(|e| e.1);
            valve.set_coil(now, on, &mut random);
            if valve.is_open() != before {
                moved.push((now, valve.is_open()));
            }
        }
        moved
    }

    #[test]
    fn poppet_follows_after_its_delays() {
        let mut v = Valve::new(3_500.0, 2_000.0, 0.0);
        let moved = movements(&mut v, &[(1_000, true), (11_000, false)]);
        assert_eq!(moved, [(4_500, true), (13_000, false)]);
    }

    #[test]
    fn pulse_shorter_than_the_delay_does_nothing() {
        let mut v = Valve::new(3_500.0, 2_000.0, 0.0);
        assert_eq!(movements(&mut v, &[(1_000, true), (4_499, false)]), []);
    }

    #[test]
    fn coils_need_less_voltage_to_hold_than_to_open() {
        for (share, opens, holds) in
            [(1.0, true, true), (0.7, true, true), (0.69, false, true), (0.35, false, true), (0.34, false, false)]
        {
            assert_eq!((Coils::at(share).act(false), Coils::at(share).act(true)), (opens, holds), "{share}");
        }
    }

    #[test]
    fn short_gap_does_not_close_an_open_valve() {
        let mut v = Valve::new(3_500.0, 2_000.0, 0.0);
        let edges = [(0, true), (10_000, false), (11_999, true)];
        assert_eq!(movements(&mut v, &edges), [(3_500, true)]);
    }

    #[test]
    fn coil_edge_at_the_moment_of_movement_comes_too_late() {
        let mut v = Valve::new(3_500.0, 2_000.0, 0.0);
        let edges = [(1_000, true), (4_500, false)];
        assert_eq!(movements(&mut v, &edges), [(4_500, true), (6_500, false)]);
    }

    #[test]
    fn without_delay_the_poppet_moves_with_the_coil() {
        let mut v = Valve::new(0.0, 0.0, 0.0);
        let edges = [(100, true), (101, false)];
        assert_eq!(movements(&mut v, &edges), [(100, true), (101, false)]);
    }

    #[test]
    fn jitter_stays_inside_its_band_and_fills_it() {
        let mut random = Random::new(7, 0);
        let (mut least, mut most) = (u64::MAX, 0);
        for _ in 0..2_000 {
            let mut v = Valve::new(3_500.0, 2_000.0, 250.0);
            v.set_coil(0, true, &mut random);
            least = least.min(v.due_us());
            most = most.max(v.due_us());
        }
        assert!((3_250..3_260).contains(&least), "{least}");
        assert!((3_741..=3_750).contains(&most), "{most}");
    }
}
