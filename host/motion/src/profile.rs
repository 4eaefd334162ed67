//! How a move passes from one value to the next.

/// Share of the way at a share of the time: the polynomial of least jerk that starts and ends at rest.
pub(super) fn minimum_jerk(time_share: f64) -> f64 {
    let t = time_share.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Largest rate of [`minimum_jerk`], at half the time.
pub(super) const PEAK_RATE: f64 = 1.875;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn move_starts_and_ends_at_rest_and_is_fastest_in_the_middle() {
        let h = 1e-4;
        let rate = |t: f64| (minimum_jerk(t + h) - minimum_jerk(t - h)) / (2.0 * h);
        assert_eq!((minimum_jerk(-1.0), minimum_jerk(0.0), minimum_jerk(1.0), minimum_jerk(2.0)), (0.0, 0.0, 1.0, 1.0));
        assert!(rate(h).abs() < 1e-6 && rate(1.0 - h).abs() < 1e-6);
        assert!((rate(0.5) - PEAK_RATE).abs() < 1e-6);
        assert!((minimum_jerk(0.3) + minimum_jerk(0.7) - 1.0).abs() < 1e-15);
    }
}
