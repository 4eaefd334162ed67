//! The way of a move through setpoints, on the clock of its phase.

use super::profile::Shaper;

/// How the setpoints of a phase change with time.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Path {
    /// Straight legs from row to row of setpoints, each of least jerk, at rest between them.
    Legs {
        /// The rows; at least two.
        rows: Vec<Vec<f64>>,
        /// When each row is reached, us after the start of the move; the first is 0.
        times_us: Vec<f64>,
        /// Shaper of every leg.
        shaper: Shaper,
    },
    /// Through rows of setpoints at given times, smooth and between neighbouring rows within them; at rest at both ends.
    Series {
        /// The rows; at least two.
        rows: Vec<Vec<f64>>,
        /// Their times, us after the start of the move; the first is 0.
        times_us: Vec<f64>,
    },
}

impl Path {
    /// A path of legs whose times are given, s.
    pub(super) fn legs(rows: Vec<Vec<f64>>, leg_times_s: &[f64], move_us: u64) -> Self {
        let whole: f64 = leg_times_s.iter().sum();
        let mut times_us = vec![0.0];
        let mut passed = 0.0;
        for time_s in leg_times_s {
            passed += time_s;
            times_us.push(move_us as f64 * passed / whole);
        }
        // The last as it is, not as a sum gives it.
        if let Some(last) = times_us.last_mut() {
            *last = move_us as f64;
        }
        Self::Legs { rows, times_us, shaper: Shaper::none() }
    }

    /// The same way with legs that take a multiple of their time, shaped besides; a series stays as it is.
    pub(super) fn retimed(&self, by: f64, new: &Shaper) -> Self {
        let Self::Legs { rows, times_us, shaper } = self else { return self.clone() };
        let own_s = |pair: &[f64]| (by * (pair[1] - pair[0] - shaper.longer_us()) + new.longer_us()) * 1e-6;
        let times_s: Vec<f64> = times_us.windows(2).map(own_s).collect();
        let move_us = (1e6 * times_s.iter().sum::<f64>()).round() as u64;
        let Self::Legs { rows, times_us, .. } = Self::legs(rows.clone(), &times_s, move_us) else {
            return self.clone();
        };
        Self::Legs { rows, times_us, shaper: new.clone() }
    }

    /// Whether a shaper makes no leg faster.
    pub(super) fn is_gentle(&self, new: &Shaper) -> bool {
        match self {
            Self::Legs { times_us, shaper, .. } => {
                times_us.windows(2).all(|pair| new.is_gentle(pair[1] - pair[0] - shaper.longer_us()))
            }
            Self::Series { .. } => true,
        }
    }

    /// Time of the last row, us.
    pub(super) fn move_us(&self) -> u64 {
        let (Self::Legs { times_us, .. } | Self::Series { times_us, .. }) = self;
        times_us.last().map_or(1, |time| *time as u64)
    }

    /// The setpoints at a time after the start, us; before the first and after the last row they rest.
    pub(super) fn at(&self, time_us: f64) -> Vec<f64> {
        let (Self::Legs { rows, times_us, .. } | Self::Series { rows, times_us }) = self;
        let cell =
            times_us.partition_point(|time| *time <= time_us).saturating_sub(1).min(rows.len().saturating_sub(2));
        let (start, length) = (times_us[cell], times_us[cell + 1] - times_us[cell]);
        let share = (time_us - start) / length;
        let (before, after) = (&rows[cell], &rows[cell + 1]);
        match self {
            Self::Legs { shaper, .. } => {
                let share = shaper.share(time_us - start, length);
                before.iter().zip(after).map(|(a, b)| a + (b - a) * share).collect()
            }
            Self::Series { .. } => {
                let one = |module: usize| {
                    let slopes = [cell, cell + 1].map(|row| length * slope(rows, times_us, row, module));
                    hermite([before[module], after[module]], slopes, share.clamp(0.0, 1.0))
                };
                (0..before.len()).map(one).collect()
            }
        }
    }
}

/// Rate of a setpoint at a row, per us: the harmonic mean of those on both sides, so that the way does not leave the values of its
/// rows (Fritsch and Butland); zero at an extreme value and at both ends.
fn slope(rows: &[Vec<f64>], times_us: &[f64], row: usize, module: usize) -> f64 {
    if row == 0 || row + 1 == rows.len() {
        return 0.0;
    }
    let rate = |from: usize| (rows[from + 1][module] - rows[from][module]) / (times_us[from + 1] - times_us[from]);
    let (before, after) = (rate(row - 1), rate(row));
    if before * after <= 0.0 {
        return 0.0;
    }
    let (h1, h2) = (times_us[row] - times_us[row - 1], times_us[row + 1] - times_us[row]);
    let (w1, w2) = (2.0 * h2 + h1, h2 + 2.0 * h1);
    (w1 + w2) / (w1 / before + w2 / after)
}

fn hermite([a, b]: [f64; 2], [slope_a, slope_b]: [f64; 2], t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    a + (b - a) * (3.0 * t2 - 2.0 * t3) + slope_a * (t3 - 2.0 * t2 + t) + slope_b * (t3 - t2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_rest_at_their_via_points_and_end_at_their_rows() {
        let path = Path::legs(vec![vec![0.0], vec![1.0], vec![-1.0]], &[1.0, 3.0], 4_000_000);
        let value = |time_us: f64| path.at(time_us)[0];
        assert_eq!((value(-5.0), value(0.0), value(1e6), value(4e6), value(9e6)), (0.0, 0.0, 1.0, -1.0, -1.0));
        assert!((value(0.5e6) - 0.5).abs() < 1e-12 && value(2.5e6).abs() < 1e-12);
        assert!((value(1e6 + 100.0) - value(1e6 - 100.0)).abs() < 1e-8);
    }

    #[test]
    fn retimed_legs_keep_their_rows_and_get_longer_by_the_shaper() {
        let path = Path::legs(vec![vec![0.0], vec![1.0], vec![-1.0]], &[1.0, 3.0], 4_000_000);
        let shaper = Shaper::zero_derivative(0.8, 0.02);
        let shaped = path.retimed(1.5, &shaper);
        assert_eq!(shaped.move_us(), 6_000_000 + (2.0 * shaper.longer_us()).round() as u64);
        let value = |time_us: f64| shaped.at(time_us)[0];
        let via_us = 1.5e6 + shaper.longer_us();
        assert!((value(via_us) - 1.0).abs() < 1e-9 && (value(shaped.move_us() as f64) + 1.0).abs() < 1e-12);
        let back = shaped.retimed(1.0 / 1.5, &Shaper::none());
        assert_eq!(back.move_us(), 4_000_000);
    }

    #[test]
    fn series_passes_its_rows_smoothly_and_stays_between_them() {
        let rows = [0.0, 1.0, 1.5, 1.2, 1.2, 0.0].map(|value| vec![value]).to_vec();
        let times_us = vec![0.0, 1e6, 3e6, 3.5e6, 5e6, 6e6];
        let path = Path::Series { rows: rows.clone(), times_us: times_us.clone() };
        let value = |time_us: f64| path.at(time_us)[0];
        for (row, time_us) in rows.iter().zip(&times_us) {
            assert!((value(*time_us) - row[0]).abs() < 1e-12);
            let (left, right) = (value(time_us - 10.0), value(time_us + 10.0));
            assert!((right - row[0] - (row[0] - left)).abs() < 1e-8, "the rate has no step at {time_us}");
        }
        for step in 0..600 {
            let time_us = 1e4 * f64::from(step);
            let cell = times_us.iter().rposition(|time| *time <= time_us).unwrap();
            let (a, b) = (rows[cell][0], rows[cell + 1][0]);
            assert!((a.min(b) - 1e-12..=a.max(b) + 1e-12).contains(&value(time_us)));
        }
    }
}
