//! How a move passes from one value to the next.

/// Share of the way at a share of the time: the polynomial of least jerk that starts and ends at rest.
pub(super) fn minimum_jerk(time_share: f64) -> f64 {
    let t = time_share.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Largest rate of [`minimum_jerk`], at half the time.
pub(super) const PEAK_RATE: f64 = 1.875;

/// Impulses that a move is convolved with (input shaping): a move becomes several smaller ones, each begun later.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shaper {
    /// Share of the move and delay, us; shares sum to 1, delays rise from 0.
    impulses: Vec<(f64, f64)>,
}

impl Shaper {
    /// No shaping.
    pub(super) fn none() -> Self {
        Self { impulses: vec![(1.0, 0.0)] }
    }

    /// Two impulses that leave no vibration of a frequency, Hz, with a damping ratio below 1.
    pub(super) fn zero_vibration(frequency_hz: f64, damping: f64) -> Self {
        let (decay, half_us) = half_period(frequency_hz, damping);
        let whole = 1.0 + decay;
        Self { impulses: vec![(1.0 / whole, 0.0), (decay / whole, half_us)] }
    }

    /// Three impulses that leave none either where the frequency is a little off: the vibration's derivative by it is zero, too.
    pub(super) fn zero_derivative(frequency_hz: f64, damping: f64) -> Self {
        let (decay, half_us) = half_period(frequency_hz, damping);
        let whole = (1.0 + decay) * (1.0 + decay);
        Self {
            impulses: vec![(1.0 / whole, 0.0), (2.0 * decay / whole, half_us), (decay * decay / whole, 2.0 * half_us)],
        }
    }

    /// By how much a move gets longer, us.
    pub(super) fn length_us(&self) -> f64 {
        self.impulses.last().map_or(0.0, |(_, delay_us)| *delay_us)
    }

    /// Share of the way at a time of a move of least jerk that is longer than [`Shaper::length_us`].
    pub(super) fn share(&self, time_us: f64, length_us: f64) -> f64 {
        let own_us = length_us - self.length_us();
        self.impulses.iter().map(|(share, delay_us)| share * minimum_jerk((time_us - delay_us) / own_us)).sum()
    }
}

/// Decay of a vibration in half a damped period, and that time, us.
fn half_period(frequency_hz: f64, damping: f64) -> (f64, f64) {
    let damped = (1.0 - damping * damping).sqrt();
    ((-std::f64::consts::PI * damping / damped).exp(), 0.5e6 / (frequency_hz * damped))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What impulses leave of a damped vibration: `sum A e^(a t) e^(i w t)` is zero, and for three impulses its derivative by `w`, too.
    #[test]
    fn shapers_leave_no_vibration_of_their_frequency() {
        let (hz, damping) = (0.83, 0.05);
        let left = |shaper: &Shaper, off: f64| {
            let w = std::f64::consts::TAU * hz * off;
            let (a, d) = (w * damping, w * (1.0_f64 - damping * damping).sqrt());
            let sum = |by: fn(f64) -> f64| {
                let one =
                    |(share, delay_us): &(f64, f64)| share * (a * delay_us * 1e-6).exp() * by(d * delay_us * 1e-6);
                shaper.impulses.iter().map(one).sum::<f64>()
            };
            sum(f64::cos).hypot(sum(f64::sin))
        };
        let (two, three) = (Shaper::zero_vibration(hz, damping), Shaper::zero_derivative(hz, damping));
        assert!(left(&two, 1.0) < 1e-12 && left(&three, 1.0) < 1e-12);
        assert!(left(&two, 1.01) > 0.01 && left(&three, 1.01) < 5e-4);
        assert!((left(&Shaper::none(), 1.1) - 1.0).abs() < 1e-15);
        for shaper in [two, three] {
            assert!((shaper.impulses.iter().map(|(share, _)| share).sum::<f64>() - 1.0).abs() < 1e-15);
            let length_us = shaper.length_us() + 1e6;
            assert!(shaper.share(0.0, length_us) == 0.0 && (shaper.share(length_us, length_us) - 1.0).abs() < 1e-15);
        }
    }

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
