//! Share of a control period in which the coils were energized.

use crate::valve::ValvePulse;

/// Full scale of the duty.
const FULL: i32 = 127;

/// Coil time of the control period in progress and the duty of the last one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Duty {
    coil_us: i32,
    share: i8,
}

impl Duty {
    /// No coil energized yet.
    pub const fn new() -> Self {
        Self { coil_us: 0, share: 0 }
    }

    /// Adds one tick; `begins` a control period of `period_us` > 0.
    pub fn add(&mut self, pulse: ValvePulse, begins: bool, period_us: u32) {
        if begins {
            let period_us = i32::try_from(period_us).unwrap_or(i32::MAX).max(1);
            // Within -127..=127 after the clamp.
            self.share = (self.coil_us.saturating_mul(FULL) / period_us).clamp(-FULL, FULL) as i8;
            self.coil_us = 0;
        }
        self.coil_us = self.coil_us.saturating_add(i32::from(pulse.fill_us) - i32::from(pulse.vent_us));
    }

    /// Duty of the last period in 1/127: positive fills, negative vents.
    pub fn share(&self) -> i8 {
        self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_of_the_period_is_a_quarter_of_full_scale() {
        let mut duty = Duty::new();
        for tick in 0..21 {
            let vent_us = if tick < 5 { 1_000 } else { 0 };
            duty.add(ValvePulse { fill_us: 0, vent_us }, tick % 20 == 0, 20_000);
        }
        assert_eq!(duty.share(), -31);
    }

    #[test]
    fn open_valve_is_full_scale() {
        let mut duty = Duty::new();
        for tick in 0..21 {
            duty.add(ValvePulse { fill_us: 1_000, vent_us: 0 }, tick % 20 == 0, 20_000);
        }
        assert_eq!(duty.share(), 127);
    }
}
