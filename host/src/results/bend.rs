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

/// A line for each bending module with a stated winding.
pub(crate) fn rows(limb: &Limb) -> Vec<String> {
    let row = |module: &LimbModule| Some(format!("  {:<16} bends by {}", module.name, module.bend()?));
    limb.modules().iter().filter_map(row).collect()
}
