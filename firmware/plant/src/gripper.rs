//! The gripper: jaws that take their time from open to closed, and as long back.

use crate::plant::TICK_US;

/// Jaws that move evenly while their output changes nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gripper {
    /// Ticks from open to closed.
    dwell: u32,
    /// Ticks that the jaws have gone towards closed.
    gone: u32,
    /// Closed, where they take no time.
    at_once: bool,
}

impl Gripper {
    /// Open jaws that close in `time_s`, rounded to ticks.
    pub(crate) fn new(time_s: f64) -> Self {
        let dwell = (time_s * 1e6 / TICK_US as f64).round() as u32;
        Self { dwell, gone: 0, at_once: false }
    }

    /// Advances by one tick with the output on or off.
    pub(crate) fn step(&mut self, on: bool) {
        self.gone = if on { (self.gone + 1).min(self.dwell) } else { self.gone.saturating_sub(1) };
        self.at_once = on;
    }

    /// Share of the way from open to closed; exactly 1 once they are.
    pub(crate) fn closure(&self) -> f64 {
        match self.dwell {
            0 => f64::from(u8::from(self.at_once)),
            dwell => f64::from(self.gone) / f64::from(dwell),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(gripper: &mut Gripper, on: bool, ticks: usize) -> f64 {
        (0..ticks).for_each(|_| gripper.step(on));
        gripper.closure()
    }

    #[test]
    fn jaws_close_and_open_in_their_time() {
        let mut gripper = Gripper::new(0.3);
        assert_eq!(after(&mut gripper, true, 150), 0.5);
        assert!(after(&mut gripper, true, 149) < 1.0);
        assert_eq!(after(&mut gripper, true, 1), 1.0);
        assert_eq!(after(&mut gripper, true, 5_000), 1.0);
        assert!(after(&mut gripper, false, 1) < 1.0);
        assert!(after(&mut gripper, false, 298) > 0.0);
        assert_eq!(after(&mut gripper, false, 1), 0.0);
    }

    #[test]
    fn jaws_turn_back_from_where_they_are() {
        let mut gripper = Gripper::new(0.2);
        assert_eq!(after(&mut gripper, true, 100), 0.5);
        assert_eq!(after(&mut gripper, false, 50), 0.25);
        assert_eq!(after(&mut gripper, true, 150), 1.0);
    }

    #[test]
    fn jaws_without_a_dwell_follow_at_once() {
        let mut gripper = Gripper::new(0.0);
        assert_eq!(after(&mut gripper, true, 1), 1.0);
        assert_eq!(after(&mut gripper, false, 1), 0.0);
    }
}
