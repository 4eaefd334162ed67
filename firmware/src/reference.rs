//! Reference pressure of a channel during one control period.

/// Rate of the reference up to which it rests, Pa/s: that of creep.
const RESTING_PA_PER_S: f32 = 1_500.0;

/// The pressure the chamber should have: linear over the control period that begins at `start_us`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Begin of the period, us.
    pub start_us: u64,
    /// Desired gauge pressure at its begin, Pa.
    pub start_pa: f32,
    /// Length of the period, us, > 0.
    pub period_us: u32,
    /// Desired gauge pressure at its end, Pa.
    pub end_pa: f32,
}

impl Reference {
    /// Desired gauge pressure at a time, Pa; the nearer end outside of the period.
    pub fn at(&self, time_us: u64) -> f32 {
        let elapsed = time_us.saturating_sub(self.start_us).min(u64::from(self.period_us));
        let share = elapsed as f32 / self.period_us.max(1) as f32;
        self.start_pa + (self.end_pa - self.start_pa) * share
    }

    /// Whether the desired pressure changes slowly enough for fine regulation.
    pub fn is_resting(&self) -> bool {
        (self.end_pa - self.start_pa).abs() <= RESTING_PA_PER_S * self.period_us as f32 * 1e-6
    }

    /// Time from `now_us` to the end of the period, us.
    pub fn rest_us(&self, now_us: u64) -> u32 {
        self.period_us.saturating_sub(u32::try_from(now_us.saturating_sub(self.start_us)).unwrap_or(u32::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reference_is_linear_and_keeps_its_ends() {
        let reference = Reference { start_us: 1_000, start_pa: 10.0, period_us: 20_000, end_pa: 30.0 };
        for (time_us, pressure_pa) in [(0, 10.0), (1_000, 10.0), (11_000, 20.0), (21_000, 30.0), (99_000, 30.0)] {
            assert_eq!(reference.at(time_us), pressure_pa, "{time_us}");
        }
        assert_eq!((reference.rest_us(6_000), reference.rest_us(99_000)), (15_000, 0));
    }
}
