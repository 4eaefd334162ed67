//! The models of bending modules in results.

use serde::Serialize;

use softlimb_limb::{Limb, LimbModule};

/// The model of a bend, as `--json` prints it.
#[derive(Serialize)]
pub(crate) struct PrintedBend {
    model: &'static str,
    /// Largest relative error that the analytic model states up to the highest pressure.
    analytic_error: Option<f64>,
    /// Largest relative change of the bend if the winding is 2 deg off.
    winding_2deg: Option<f64>,
}

impl PrintedBend {
    /// The bend of a module; `None` of straight modules, and of benders with an ideal winding.
    pub(crate) fn of(module: &LimbModule) -> Option<Self> {
        let bend = module.bend()?;
        Some(Self { model: bend.model(), analytic_error: bend.analytic_error(), winding_2deg: module.winding_effect() })
    }
}

/// The bends of the modules of a limb; `null` of straight ones, and of benders with an ideal winding.
pub(crate) fn of_limb(limb: &Limb) -> Vec<Option<PrintedBend>> {
    limb.modules().iter().map(PrintedBend::of).collect()
}

/// An answer about a limb with the models of its bends, and what 2 deg of winding do to them.
#[derive(Serialize)]
struct WithBends<'a, T> {
    #[serde(flatten)]
    answer: &'a T,
    bends: Vec<Option<PrintedBend>>,
}

/// An answer about a limb with the models of its bends as `bends`, one a module.
pub fn with_bends<'a, T: Serialize>(limb: &Limb, answer: &'a T) -> impl Serialize + use<'a, T> {
    WithBends { answer, bends: of_limb(limb) }
}

/// The bends of a series: one a segment from the base to the tip, `null` for those that are straight or have an ideal winding. Nothing for
/// another module.
pub(crate) fn of_segments(module: &LimbModule) -> Option<Vec<Option<PrintedBend>>> {
    module.is_series().then(|| module.segments().iter().map(PrintedBend::of).collect())
}

/// The effect of 2 deg of winding, at the end of a line about a bend.
pub(crate) fn two_degrees(share: f64) -> String {
    format!("; 2 deg of fiber angle change the bend by up to {:.1} %", 100.0 * share)
}

/// A line for each bending module or segment with a stated winding.
pub(crate) fn rows(limb: &Limb) -> Vec<String> {
    let row = |part: &LimbModule| {
        let off = part.winding_effect().map_or(String::new(), two_degrees);
        Some(format!("  {:<16} bends by {}{off}", part.name, part.bend()?))
    };
    limb.parts().filter_map(row).collect()
}
