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

    fn push(&mut self, time_s: f64, row: Vec<f64>) {
        self.times_s.push(time_s);
        self.rows.push(row);
    }
}

/// Corrections of a scene's phases, whatever their durations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseCorrections {
    /// For each phase, in the scene's order, its rows in order of time; one at least.
    pub phases: Vec<Vec<CorrectionRow>>,
}

/// Corrections at a time of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectionRow {
    /// Share of the move, 0 to 1.
    pub move_share: f64,
    /// Time since the end of the move, s; 0 before.
    pub hold_s: f64,
    /// For each actuator its correction, in the unit of its module's setpoints.
    pub values: Vec<f64>,
    /// For each actuator the planned setpoint that was corrected; empty where the file does not state it.
    pub planned: Vec<f64>,
}

/// Times of a phase in a run, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseTimes {
    /// Start of the move, after the start of the run.
    pub start_s: f64,
    /// Duration of the move.
    pub move_s: f64,
    /// Duration of the hold.
    pub hold_s: f64,
}

impl PhaseTimes {
    /// End of the hold, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.move_s + self.hold_s
    }
}

impl PhaseCorrections {
    /// The corrections over the time of a run whose phases have these times, in the same order.
    ///
    /// Moves are stretched. Of a shorter hold the rest is left out; in a longer one the last row holds until its end. A phase begins with the last
    /// correction of the phase before. A run without a row at its start begins without a correction.
    pub fn over(&self, phases: &[PhaseTimes]) -> Corrections {
        let mut series = Corrections::default();
        for (rows, times) in self.phases.iter().zip(phases) {
            let end_s = times.end_s();
            let timed = rows.iter().map(|row| (times.start_s + row.move_share * times.move_s + row.hold_s, row));
            match timed.clone().next().filter(|_| series.times_s.is_empty()) {
                Some((time_s, row)) if time_s > times.start_s => {
                    series.push(times.start_s, vec![0.0; row.values.len()])
                }
                Some((_, row)) => series.push(times.start_s, row.values.clone()),
                None => {}
            }
            for (time_s, row) in timed.clone().filter(|(time_s, _)| *time_s > times.start_s && *time_s < end_s) {
                series.push(time_s, row.values.clone());
            }
            let beyond = timed.clone().find(|(time_s, _)| *time_s >= end_s);
            let at_end = match (beyond, series.times_s.last().zip(series.rows.last())) {
                (Some((time_s, row)), Some((before_s, before))) if time_s > end_s => {
                    let share = (end_s - before_s) / (time_s - before_s);
                    before.iter().zip(&row.values).map(|(a, b)| a + (b - a) * share).collect()
                }
                (Some((_, row)), _) => row.values.clone(),
                (None, last) => last.map(|(_, row)| row.clone()).unwrap_or_default(),
            };
            series.push(end_s, at_end);
        }
        series
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

    fn row(move_share: f64, hold_s: f64, value: f64) -> CorrectionRow {
        CorrectionRow { move_share, hold_s, values: vec![value], planned: Vec::new() }
    }

    #[test]
    fn corrections_by_phase_follow_the_times_of_a_run() {
        let first = vec![row(0.0, 0.0, 1.0), row(0.5, 0.0, 2.0), row(1.0, 0.0, 4.0), row(1.0, 3.0, 10.0)];
        let corrections = PhaseCorrections { phases: vec![first, vec![row(1.0, 1.0, 20.0)]] };
        let over = |[move_s, hold_s]: [f64; 2]| {
            let first = PhaseTimes { start_s: 0.0, move_s, hold_s };
            corrections.over(&[first, PhaseTimes { start_s: first.end_s(), move_s: 1.0, hold_s: 1.0 }])
        };
        let is = |series: &Corrections, expected: &[(f64, f64)]| {
            for (time_s, value) in expected {
                assert_eq!(series.at(*time_s), [*value], "{time_s} s: {series:?}");
            }
        };
        // As learned: a move of 2 s and a hold of 3 s.
        is(&over([2.0, 3.0]), &[(0.0, 1.0), (1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (3.5, 7.0), (5.0, 10.0), (6.0, 15.0)]);
        // A hold of 8 s keeps the last row, and the next phase begins from it.
        is(&over([2.0, 8.0]), &[(5.0, 10.0), (9.0, 10.0), (10.0, 10.0), (11.0, 15.0), (12.0, 20.0)]);
        // A hold of 1.5 s ends in the middle, and the next phase begins from there.
        is(&over([2.0, 1.5]), &[(2.0, 4.0), (3.5, 7.0), (4.5, 13.5), (5.5, 20.0)]);
        // A move that takes twice as long.
        is(&over([4.0, 3.0]), &[(2.0, 2.0), (3.0, 3.0), (4.0, 4.0), (7.0, 10.0)]);
        // In another order there is no step: each phase begins where the one before ended, and the run without a correction.
        let exchanged = PhaseCorrections { phases: corrections.phases.iter().rev().cloned().collect() };
        let second = PhaseTimes { start_s: 0.0, move_s: 1.0, hold_s: 1.0 };
        let series = exchanged.over(&[second, PhaseTimes { start_s: second.end_s(), move_s: 2.0, hold_s: 3.0 }]);
        is(&series, &[(0.0, 0.0), (1.0, 10.0), (2.0, 20.0), (2.5, 11.0), (3.0, 2.0), (4.0, 4.0), (7.0, 10.0)]);
        // No hold.
        is(&over([2.0, 0.0]), &[(2.0, 4.0), (3.0, 12.0), (4.0, 20.0)]);
    }
}
