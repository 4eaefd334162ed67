//! Margins of the loaded limb, as `softlimb check` prints them.

use softlimb_limb::statics::{BUCKLING_MARGIN_MAX, LOAD_FACTOR_MAX};
use softlimb_motion::{Margins, Plan};

/// A line a phase, with a heading; nothing of a weightless limb.
pub(super) fn rows(plan: &Plan, margins: &[Margins]) -> Vec<String> {
    if margins.is_empty() {
        return Vec::new();
    }
    let heading = format!(
        "  {:<16} {:>7} {:>11} {:>9} {:>8} {:>9} {:>9}",
        "margins", "payload", "load factor", "stiffness", "sag", "buckling", "pressure"
    );
    let units = format!("  {:<16} {:>7} {:>11} {:>9} {:>8} {:>9} {:>9}", "", "kg", "", "N/m", "mm", "", "%");
    let row = |(phase, margins): (&softlimb_motion::PlannedPhase, &Margins)| {
        format!(
            "  {:<16} {:7.2} {:>11} {:9.1} {:8.1} {:>9} {:9.1}",
            phase.name,
            margins.payload_kg,
            load_factor(margins.load_factor),
            margins.stiffness_n_per_m,
            1e3 * margins.sag_m,
            buckling_margin(margins.buckling_margin),
            100.0 * margins.pressure_share,
        )
    };
    [heading, units].into_iter().chain(plan.phases.iter().zip(margins).map(row)).collect()
}

/// A load factor as printed: the largest stands for all that are larger.
pub(super) fn load_factor(factor: f64) -> String {
    up_to(LOAD_FACTOR_MAX, factor, 2)
}

fn buckling_margin(margin: f64) -> String {
    up_to(BUCKLING_MARGIN_MAX, margin, 1)
}

/// A value that is computed up to a largest, which stands for all that are larger.
pub(super) fn up_to(largest: f64, value: f64, digits: usize) -> String {
    if value < largest { format!("{value:.digits$}") } else { format!("> {largest:.0}") }
}
