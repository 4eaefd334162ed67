//! From the units of an axis to pixels, and the ticks on the way.

use super::Ticks;

/// Smallest interval that holds all finite values, widened by a twentieth on both
/// sides; an interval of some width also for one value or none.
pub fn span(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    let [low, high] =
        finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low > high {
        return [0.0, 1.0];
    }
    // Half each before subtracting: the difference of two huge values must stay finite.
    let half = (high / 2.0 - low / 2.0).max(0.01 * low.abs().max(high.abs())).max(1e-9);
    let [low, high] = [low / 2.0 + high / 2.0 - 1.1 * half, low / 2.0 + high / 2.0 + 1.1 * half];
    [low.max(f64::MIN / 4.0), high.min(f64::MAX / 4.0)]
}

/// Points with a corner before each of them, for a quantity that keeps its value up to the next point.
pub fn steps(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let corners = points.windows(2).flat_map(|pair| [[pair[1][0], pair[0][1]], pair[1]]);
    points.first().copied().into_iter().chain(corners).collect()
}

/// A linear map from an interval of values to one of pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    values: [f64; 2],
    pixels: [f64; 2],
}

impl Scale {
    /// Maps the ends of `values` to the ends of `pixels`. An interval that is empty or
    /// not finite is replaced by [0, 1].
    pub(super) fn new(values: [f64; 2], pixels: [f64; 2]) -> Self {
        let [low, high] = values;
        let usable = low.is_finite() && high.is_finite() && high > low && (high - low).is_finite();
        Self { values: if usable { values } else { [0.0, 1.0] }, pixels }
    }

    /// Pixel of a value; values far outside stop a little beyond the end.
    pub(super) fn pixel(&self, value: f64) -> f64 {
        let [low, high] = self.values;
        let share = ((value - low) / (high - low)).clamp(-10.0, 11.0);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// Round values inside the interval, about one per `spacing_px`, with their labels.
    pub(super) fn ticks(&self, spacing_px: f64) -> Vec<(f64, String)> {
        let [low, high] = self.values;
        let count = ((self.pixels[1] - self.pixels[0]).abs() / spacing_px).max(1.0);
        let step = round_step((high - low) / count);
        let (first, last) = ((low / step).ceil(), (high / step).floor());
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        // Far from zero the steps fall below the resolution of the values: no ticks then.
        if !(last - first).is_finite() || first.abs().max(last.abs()) > 1e12 {
            return Vec::new();
        }
        (0..=(last - first) as u32)
            .map(|index| (first + f64::from(index)) * step + 0.0)
            .map(|value| (value, label(value, decimals)))
            .collect()
    }

    /// The marks along an axis: round values about one per `spacings_px[0]`, or powers at least `spacings_px[1]` apart.
    pub(super) fn marks(&self, ticks: &Ticks, spacings_px: [f64; 2]) -> Vec<(f64, String)> {
        match ticks {
            Ticks::Round => self.ticks(spacings_px[0]),
            Ticks::Powers => self.decades(spacings_px[1]),
            Ticks::Names(names) => (0..).map(f64::from).zip(names.iter().cloned()).collect(),
        }
    }

    /// Ticks at whole exponents of ten, at least `spacing_px` apart, labelled as powers.
    pub(super) fn decades(&self, spacing_px: f64) -> Vec<(f64, String)> {
        let [low, high] = self.values;
        let per_decade = (self.pixels[1] - self.pixels[0]).abs() / (high - low);
        let step = (spacing_px / per_decade).ceil().max(1.0);
        let (first, last) = ((low / step).ceil(), (high / step).floor());
        if !(0.0..1e3).contains(&(last - first)) {
            return Vec::new();
        }
        (0..=(last - first) as u32)
            .map(|index| (first + f64::from(index)) * step + 0.0)
            .map(|exponent| (exponent, power(exponent)))
            .collect()
    }
}

/// A power of ten; the drawing raises its exponent.
fn power(exponent: f64) -> String {
    format!("10^{exponent:.0}")
}

/// Smallest of 1, 2, 5 times a power of ten that is not below `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10_f64.powf(rough.log10().floor());
    let lead = rough / power;
    // The small excess keeps 2.0000000001 from becoming 5.
    power * [1.0, 2.0, 5.0].into_iter().find(|round| lead <= round * (1.0 + 1e-9)).unwrap_or(10.0)
}

fn label(value: f64, decimals: usize) -> String {
    match value.abs() >= 1e6 {
        true => format!("{value:.1e}"),
        false => format!("{value:.decimals$}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: [f64; 2]) -> Vec<String> {
        Scale::new(range, [0.0, 500.0]).ticks(100.0).into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(labels([0.0, 20.0]), ["0", "5", "10", "15", "20"]);
        assert_eq!(labels([-0.13, 0.31]), ["-0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels([0.98, 1.33]), ["1.0", "1.1", "1.2", "1.3"]);
        assert_eq!(labels([0.0, 10.0]), ["0", "2", "4", "6", "8", "10"]);
    }

    #[test]
    fn decades_are_whole_and_far_enough_apart() {
        let labels = |range, spacing| {
            let ticks = Scale::new(range, [0.0, 100.0]).decades(spacing);
            ticks.into_iter().map(|(_, label)| label).collect::<Vec<_>>()
        };
        assert_eq!(labels([-3.0, 1.0], 20.0), ["10^-3", "10^-2", "10^-1", "10^0", "10^1"]);
        assert_eq!(labels([-3.5, 1.0], 40.0), ["10^-2", "10^0"]);
        assert_eq!(labels([-24.0, -12.0], 100.0), ["10^-24", "10^-12"]);
        assert!(labels([-1e9, 1e9], 1e-9).is_empty());
    }

    #[test]
    fn hopeless_intervals_still_give_a_scale() {
        for range in [[f64::NAN, 1.0], [2.0, 2.0], [3.0, 1.0], [f64::MIN, f64::MAX]] {
            assert_eq!(Scale::new(range, [0.0, 10.0]).pixel(0.5), 5.0);
        }
        assert!(Scale::new([1e15, 1e15 + 1.0], [0.0, 500.0]).ticks(100.0).is_empty());
    }

    #[test]
    fn steps_keep_a_value_up_to_the_next_point() {
        assert_eq!(
            steps(&[[0.0, 5.0], [2.0, 3.0], [3.0, 1.0]]),
            [[0.0, 5.0], [2.0, 5.0], [2.0, 3.0], [3.0, 3.0], [3.0, 1.0]]
        );
        assert_eq!(steps(&[]), [[0.0; 2]; 0]);
    }

    #[test]
    fn span_holds_its_values_with_a_margin() {
        assert_eq!(span([-1.0, f64::NAN, 1.0]), [-1.1, 1.1]);
        assert_eq!(span([]), [0.0, 1.0]);
        for values in [[4.0; 2], [0.0; 2], [f64::MIN, f64::MAX]] {
            let [low, high] = span(values);
            assert!(low < high && (high - low).is_finite(), "{values:?}: {low} {high}");
        }
        let [low, high] = span([4.0, 4.0]);
        assert!(low < 4.0 && 4.0 < high);
    }
}
