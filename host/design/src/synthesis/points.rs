//! The points of a limb's body that are kept clear during a search.

use super::task::Task;

/// Intervals of a module between its body points, and the most between those of a rigid part, m.
const INTERVALS: usize = 12;
const SPACING_M: f64 = 10e-3;

/// Radius of the body at a share of a module's length, beyond 1 of the rigid parts behind it, whose lengths are `rigid_m`, m.
pub(super) fn radius_at(task: &Task, rigid_m: [f64; 2], module_radius: f64, along: f64) -> f64 {
    let [connector_m, tool_m] = rigid_m;
    if along <= 1.0 {
        module_radius
    } else if (along - 1.0) * (connector_m + tool_m) > connector_m + 1e-12 {
        task.tool_m[1]
    } else {
        task.connector_m[1]
    }
}

/// Where the body points of a module and of the rigid parts behind it are, as shares of their lengths, the latter beyond 1; each with the
/// radius of the body there, m.
pub(super) fn body_points(task: &Task, rigid_m: [f64; 2], module_radius: f64) -> impl Iterator<Item = (f64, f64)> {
    let count = ((rigid_m[0] + rigid_m[1]) / SPACING_M).ceil() as usize;
    let module = (0..=INTERVALS).map(|step| step as f64 / INTERVALS as f64);
    let behind = (1..=count).map(move |step| 1.0 + step as f64 / count as f64);
    module.chain(behind).map(move |along| (along, radius_at(task, rigid_m, module_radius, along)))
}
