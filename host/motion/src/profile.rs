//! How a move passes from one value to the next.

/// Share of the way at a share of the time: the polynomial of least jerk that starts and ends at rest.
pub(super) fn minimum_jerk(time_share: f64) -> f64 {
    let t = time_share.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Values of a smooth course at each end that are equal, so that it begins and ends without rate and acceleration.
const AT_REST: usize = 3;
/// Parts of a move whose rates are compared.
const RATES: u32 = 200;

/// Largest rate of [`minimum_jerk`], at half the time.
pub(super) const PEAK_RATE: f64 = 1.875;

/// How a shaped move passes from one value to the next (input shaping).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shaper {
    course: Course,
    /// By how much a move gets longer, us.
    longer_us: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Course {
    /// A move convolved with impulses becomes several smaller ones, each begun later: share of the move and delay, us. Shares sum to 1, delays
    /// rise from 0.
    Impulses(Vec<(f64, f64)>),
    /// A Bezier curve over the whole time: its values rise from 0 to 1, the first and the last three are equal.
    Smooth(Vec<f64>),
}

impl Shaper {
    /// No shaping.
    pub(super) fn none() -> Self {
        Self::impulses(vec![(1.0, 0.0)])
    }

    fn impulses(impulses: Vec<(f64, f64)>) -> Self {
        let longer_us = impulses.last().map_or(0.0, |(_, delay_us)| *delay_us);
        Self { course: Course::Impulses(impulses), longer_us }
    }

    /// Two impulses that leave no vibration of a frequency, Hz, with a damping ratio below 1.
    pub(super) fn zero_vibration(frequency_hz: f64, damping: f64) -> Self {
        let (decay, half_us) = half_period(frequency_hz, damping);
        let whole = 1.0 + decay;
        Self::impulses(vec![(1.0 / whole, 0.0), (decay / whole, half_us)])
    }

    /// Three impulses that leave none either where the frequency is a little off: the vibration's derivative by it is zero, too.
    pub(super) fn zero_derivative(frequency_hz: f64, damping: f64) -> Self {
        let (decay, half_us) = half_period(frequency_hz, damping);
        let whole = (1.0 + decay) * (1.0 + decay);
        Self::impulses(vec![(1.0 / whole, 0.0), (2.0 * decay / whole, half_us), (decay * decay / whole, 2.0 * half_us)])
    }

    /// A smooth course that is longer by a time, us, whose values rise in proportion to `steps` (>= 0, not all of them 0).
    pub(super) fn smooth(steps: &[f64], longer_us: f64) -> Self {
        let sum: f64 = steps.iter().sum();
        let mut value = 0.0;
        let mut values = vec![0.0; AT_REST];
        for step in steps {
            value += step / sum;
            values.push(value);
        }
        // The last as it is, not as a sum gives it.
        values.pop();
        values.extend([1.0; AT_REST]);
        Self { course: Course::Smooth(values), longer_us }
    }

    /// By how much a move gets longer, us.
    pub(super) fn longer_us(&self) -> f64 {
        self.longer_us
    }

    /// Share of the way at a time of a shaped move, which is longer than [`Shaper::longer_us`].
    pub(super) fn share(&self, time_us: f64, length_us: f64) -> f64 {
        match &self.course {
            Course::Impulses(impulses) => {
                let own_us = length_us - self.longer_us;
                impulses.iter().map(|(share, delay_us)| share * minimum_jerk((time_us - delay_us) / own_us)).sum()
            }
            Course::Smooth(values) => bezier(values, (time_us / length_us).clamp(0.0, 1.0)),
        }
    }

    /// Whether the shaped form of a move is nowhere faster than the move itself, which takes this time, us.
    pub(super) fn is_gentle(&self, move_us: f64) -> bool {
        let length_us = move_us + self.longer_us;
        let share = |index: u32| self.share(length_us * f64::from(index) / f64::from(RATES), length_us);
        let most = (0..RATES).map(|index| share(index + 1) - share(index)).fold(0.0, f64::max);
        most * f64::from(RATES) / length_us <= PEAK_RATE / move_us
    }
}

/// The point of a Bezier curve (de Casteljau).
fn bezier(values: &[f64], t: f64) -> f64 {
    let mut points = values.to_vec();
    for level in (1..points.len()).rev() {
        for index in 0..level {
            points[index] += t * (points[index + 1] - points[index]);
        }
    }
    points[0]
}

/// Decay of a vibration in half a damped period, and that time, us.
fn half_period(frequency_hz: f64, damping: f64) -> (f64, f64) {
    let damped = (1.0 - damping * damping).sqrt();
    ((-std::f64::consts::PI * damping / damped).exp(), 0.5e6 / (frequency_hz * damped))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn impulses(shaper: &Shaper) -> &[(f64, f64)] {
        let Course::Impulses(impulses) = &shaper.course else { panic!("{shaper:?}") };
        impulses
    }

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
                impulses(shaper).iter().map(one).sum::<f64>()
            };
            sum(f64::cos).hypot(sum(f64::sin))
        };
        let (two, three) = (Shaper::zero_vibration(hz, damping), Shaper::zero_derivative(hz, damping));
        assert!(left(&two, 1.0) < 1e-12 && left(&three, 1.0) < 1e-12);
        assert!(left(&two, 1.01) > 0.01 && left(&three, 1.01) < 5e-4);
        assert!((left(&Shaper::none(), 1.1) - 1.0).abs() < 1e-15);
        for shaper in [two, three] {
            assert!((impulses(&shaper).iter().map(|(share, _)| share).sum::<f64>() - 1.0).abs() < 1e-15);
            let length_us = shaper.longer_us() + 1e6;
            assert!(shaper.share(0.0, length_us) == 0.0 && (shaper.share(length_us, length_us) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn smooth_course_starts_and_ends_at_rest_and_never_turns_back() {
        let course = Shaper::smooth(&[0.3, 0.0, 0.1, 0.4, 0.2], 0.5e6);
        let (length_us, h) = (1.5e6, 100.0);
        let share = |time_us: f64| course.share(time_us, length_us);
        assert!(share(0.0) == 0.0 && share(length_us) == 1.0 && share(2.0 * length_us) == 1.0);
        assert!((1..1500).all(|ms| share(1e3 * f64::from(ms)) >= share(1e3 * f64::from(ms - 1))));
        // The third power of the time is the first that there is.
        assert!(share(h) < 1e3 * (h / length_us).powi(3) && 1.0 - share(length_us - h) < 1e3 * (h / length_us).powi(3));
        // Of degree five with one step it is the move of least jerk.
        let plain = Shaper::smooth(&[1.0], 0.0);
        assert!(
            (0..=10)
                .all(|part| (plain.share(f64::from(part), 10.0) - minimum_jerk(0.1 * f64::from(part))).abs() < 1e-15)
        );
        assert!(plain.is_gentle(1e6) && Shaper::smooth(&[1.0], 1e5).is_gentle(1e6));
        assert!(!Shaper::smooth(&[0.0, 0.0, 1.0, 0.0, 0.0], 0.0).is_gentle(1e6));
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
