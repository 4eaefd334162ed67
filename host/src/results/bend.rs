//! The models of bending modules in results.

use serde::Serialize;

use softlimb_limb::{Bend, Limb, LimbModule};

/// The model of a bend, as `--json` prints it.
#[derive(Serialize)]
pub(crate) struct PrintedBend {
    model: &'static str,
    /// Largest relative error that the analytic model states up to the highest pressure.
    analytic_error: Option<f64>,
}

impl PrintedBend {
    pub(crate) fn new(bend: Bend) -> Self {
        Self { model: bend.model(), analytic_error: bend.analytic_error() }
    }
}

/// The bends of a series: one a segment from the base to the tip, `null` for those that are straight or have an ideal winding. Nothing for
/// another module.
pub(crate) fn of_segments(module: &LimbModule) -> Option<Vec<Option<PrintedBend>>> {
    let bends = || module.segments().iter().map(|segment| segment.bend().map(PrintedBend::new));
    module.is_series().then(|| bends().collect())
}

/// A line for each bending module or segment with a stated winding.
pub(crate) fn rows(limb: &Limb) -> Vec<String> {
    let row = |part: &LimbModule| Some(format!("  {:<16} bends by {}", part.name, part.bend()?));
    limb.parts().filter_map(row).collect()
}
