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

/// A warning for each module that a command bends by the analytic model, and `check` and `run` by finite elements.
pub(crate) fn analytic_bends(command: &str, limb: &Limb) -> Vec<String> {
    let warning = |module: &LimbModule| {
        let bend = module.bend().filter(|bend| bend.is_by_section())?;
        let errs = bend.analytic_error().map_or_else(
            || "whose error is not known".to_owned(),
            |error| format!("which errs by up to {:.1} %", 100.0 * error),
        );
        Some(format!(
            "{command} bends `{}` by the analytic model, {errs}; `check` and `run` take finite elements",
            module.name
        ))
    };
    limb.modules().iter().filter_map(warning).collect()
}
