//! Corrections of planned setpoints, so that a limb that differs from its model follows the plan.

/// Corrections of the setpoints over the time of a run: one row per instant, straight between them, constant before the first and after
/// the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corrections {
    /// Rising times since the start of the run, s.
    pub times_s: Vec<f64>,
    /// For each time one value per actuator, in the order of the channels and the unit of its module's setpoints.
    pub rows: Vec<Vec<f64>>,
}

impl Corrections {
    /// The corrections at a time, s; empty where there are none.
    pub fn at(&self, time_s: f64) -> Vec<f64> {
        let after = self.times_s.partition_point(|time| *time <= time_s);
        let (Some(last), Some(first)) = (self.rows.get(after.saturating_sub(1)), self.rows.get(after)) else {
            return self.rows.last().cloned().unwrap_or_default();
        };
        if after == 0 {
            return first.clone();
        }
        let (from, to) = (self.times_s[after - 1], self.times_s[after]);
        let share = (time_s - from) / (to - from);
        last.iter().zip(first).map(|(a, b)| a + (b - a) * share).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_are_straight_between_their_instants_and_constant_outside() {
        let corrections = Corrections { times_s: vec![1.0, 3.0], rows: vec![vec![0.0, 4.0], vec![2.0, 2.0]] };
        for (time_s, expected) in
            [(0.0, [0.0, 4.0]), (1.0, [0.0, 4.0]), (1.5, [0.5, 3.5]), (3.0, [2.0, 2.0]), (9.0, [2.0, 2.0])]
        {
            assert_eq!(corrections.at(time_s), expected, "{time_s}");
        }
        assert_eq!(Corrections::default().at(1.0), [0.0; 0]);
    }
}
