//! Figures of merit of a run as cells of the table.

use softlimb_rig::report::Summary;

/// Headings with units.
pub(super) const HEADINGS: [&str; 10] = [
    "tip_at_holds_rms [m]",
    "tip_at_holds_max [m]",
    "tip_rms [m]",
    "tip_max [m]",
    "tip_tracking_rms [m]",
    "pressure_rms [Pa]",
    "peak_pressure_share [1]",
    "misses",
    "faults",
    "duration [s]",
];

/// Cells under the headings; empty without a run or without the figure.
pub(super) fn cells(run: Option<&Summary>) -> [String; HEADINGS.len()] {
    let Some(run) = run else { return Default::default() };
    let (holds, tip, tracking) = (&run.tip.at_holds_m, &run.tip.error_m, &run.tip.tracking_error_m);
    [
        holds.as_ref().map(|error| error.rmse),
        holds.as_ref().map(|error| error.max),
        tip.as_ref().map(|error| error.rmse),
        tip.as_ref().map(|error| error.max),
        tracking.as_ref().map(|error| error.rmse),
        run.pressure.true_error_pa.as_ref().map(|error| error.rmse),
        peak_share(run),
        Some(run.misses.len() as f64),
        Some(run.faults.len() as f64),
        Some(run.duration_s),
    ]
    .map(|figure| figure.map_or(String::new(), shown))
}

/// Highest true pressure of a chamber over its limit.
fn peak_share(run: &Summary) -> Option<f64> {
    let limits = run.pressure_limit_pa.as_ref()?;
    run.peak_chamber_pa.iter().zip(limits).map(|(peak_pa, limit_pa)| peak_pa / limit_pa).reduce(f64::max)
}

/// Nine significant digits, in the shorter notation.
fn shown(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let rounded = format!("{value:.8e}").parse().unwrap_or(value);
    let plain = format!("{rounded}");
    let scientific = format!("{rounded:e}");
    if scientific.len() < plain.len() { scientific } else { plain }
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn figures_have_nine_digits_in_the_shorter_form() {
        for (value, text) in [(0.0, "0"), (1.5, "1.5"), (1.0 / 3.0, "0.333333333"), (2e-13 / 3.0, "6.66666667e-14")] {
            assert_eq!(shown(value), text);
        }
        assert_eq!(shown(f64::NAN), "");
    }
}
