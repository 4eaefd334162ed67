//! Figures of merit of a run, or of a limb that learns, as cells of the table.

use softlimb_rig::learning::{Outcome, Score};
use softlimb_rig::report::Summary;
use softlimb_scene::Experiment;

/// Headings of a run, with units.
const OF_A_RUN: [&str; 10] = [
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

/// Headings of a limb that learns, with units.
const OF_LEARNING: [&str; 8] = [
    "tip_at_targets_before_rms [m]",
    "tip_at_targets_before_max [m]",
    "tip_systematic_before [m]",
    "tip_before_rms [m]",
    "tip_at_targets_after_rms [m]",
    "tip_at_targets_after_max [m]",
    "tip_systematic_after [m]",
    "tip_after_rms [m]",
];

/// Headings of an experiment, with units.
pub(super) fn headings(experiment: Experiment) -> &'static [&'static str] {
    match experiment {
        Experiment::Run => &OF_A_RUN,
        Experiment::Learn { .. } => &OF_LEARNING,
    }
}

/// Cells under the headings of a limb that learns.
pub(super) fn of_learning(found: &Outcome) -> Vec<String> {
    let of = |score: &Score| {
        let at_targets = score.at_targets();
        [at_targets.rmse_m(), at_targets.max_m, score.systematic_m().0, score.whole_way.rmse_m()].map(shown)
    };
    [of(&found.by_model), of(&found.corrected)].concat()
}

/// Cells under the headings of a run; empty without the figure.
pub(super) fn of_a_run(run: &Summary) -> Vec<String> {
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
        run.schedule_s,
    ]
    .map(|figure| figure.map_or(String::new(), shown))
    .into()
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
