//! Error statistics.

use serde::Serialize;
use softlimb_numerics::statistics::root_mean_square;

/// Size of an error over a run, in the unit of the error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorStats {
    /// Root of the mean square.
    pub rmse: f64,
    /// Largest magnitude.
    pub max: f64,
    /// Number of values behind the two.
    pub samples: usize,
}

impl ErrorStats {
    /// Statistics of the finite errors, `None` when there are none.
    ///
    /// A quantity that was not observed at some instants is an absent value there, not
    /// a zero; [`samples`](Self::samples) shows how much is behind the figures.
    pub(super) fn of(errors: impl IntoIterator<Item = f64>) -> Option<Self> {
        let errors: Vec<f64> = errors.into_iter().filter(|error| error.is_finite()).collect();
        let rmse = root_mean_square(errors.iter().copied())?;
        Some(Self { rmse, max: errors.iter().fold(0.0_f64, |max, error| max.max(error.abs())), samples: errors.len() })
    }
}

/// Distance between two points, in their unit.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = std::array::from_fn(|axis| a[axis] - b[axis]);
    x.hypot(y).hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_a_known_sequence() {
        // mean square (9 + 16 + 0 + 25) / 4 = 12.5
        let stats = ErrorStats::of([3.0, -4.0, 0.0, -5.0]).unwrap();
        assert_eq!(stats, ErrorStats { rmse: 12.5_f64.sqrt(), max: 5.0, samples: 4 });
    }

    #[test]
    fn unobserved_samples_do_not_count() {
        let stats = ErrorStats::of([f64::NAN, 2.0, f64::INFINITY]).unwrap();
        assert_eq!(stats, ErrorStats { rmse: 2.0, max: 2.0, samples: 1 });
        assert_eq!(ErrorStats::of([f64::NAN]), None);
        assert_eq!(ErrorStats::of([]), None);
    }

    #[test]
    fn distance_of_a_box_diagonal() {
        assert_eq!(distance([1.0, 2.0, 3.0], [3.0, 5.0, 9.0]), 7.0); // 2, 3, 6
    }
}
