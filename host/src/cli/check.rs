//! `softlimb check`: the scene, and the reach of its limb.

use std::path::PathBuf;

use clap::Args;

use super::shared::{limb, show};
use super::{Failure, Outcome};
use super::{check_margins, check_swing};
use crate::results::CheckResult;
use crate::results::bend::rows;
use softlimb_chart::labelled;
use softlimb_motion::Plan;
use softlimb_scene::Scene;

/// Check a scene: keys, units, ranges, and that the limb reaches every target
#[derive(Args)]
#[command(after_help = "Example: softlimb check scenes/pick-and-place-a.toml")]
pub(super) struct Check {
    /// The scene file
    scene: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl Check {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        let result = CheckResult::new(&scene, &limb)?;
        show(self.json, &result.printed(), || table(&result))?;
        Ok(super::warn(&result.warnings))
    }
}

fn table(result: &CheckResult<'_>) -> String {
    let CheckResult { scene, limb, plan, highest, inverses, margins, swings, air, .. } = result;
    let heading = format!(
        "{}: {}, {}, {:.3} m at rest, {:.2} kg, {} in {:.1} s",
        labelled(scene.name(), scene.weightless()),
        counted(limb.modules().len(), "module"),
        counted(scene.channels(), "channel"),
        scene.rest_length_m(),
        scene.mass_kg(),
        counted(plan.phases.len(), "phase"),
        plan.duration_us() as f64 * 1e-6,
    );
    let modules = limb.modules().iter().zip(highest).zip(inverses).map(|((module, pressure), inverse)| {
        let (highest_kpa, allowed_kpa) = (pressure * 1e-3, module.pressure_max_pa * 1e-3);
        format!("  {:<16} up to {highest_kpa:6.2} kPa of {allowed_kpa:6.2} kPa, by {inverse}", module.name)
    });
    let air = format!(
        "  air of one run {:.2} litres at 100 kPa, supply at least {:.0} kPa",
        1e3 * air.volume_m3,
        1e-3 * air.supply_min_pa
    );
    let weight = plan.weighed().map(|weighed| {
        let (model, error) = (weighed.tier.name(), 100.0 * weighed.error);
        format!("  corrected for weight by the model `{model}`, with an error of {error:.2} % of the length")
    });
    std::iter::once(heading)
        .chain(modules)
        .chain(rows(limb))
        .chain([air])
        .chain(weight)
        .chain(phase_rows(scene, plan))
        .chain(check_margins::rows(plan, margins))
        .chain(check_swing::rows(scene, plan, swings))
        .collect::<Vec<_>>()
        .join("\n")
}

/// A number of things, in the singular for one.
fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// Where there are obstacles, a carried object, or moves whose time the plan chose, a line a phase.
fn phase_rows(scene: &Scene, plan: &Plan) -> Vec<String> {
    let chosen = scene.phases().iter().any(|phase| phase.move_us.is_none());
    let carries = plan.phases.iter().any(|phase| phase.tilt_rad.is_some());
    if scene.obstacles().is_empty() && !chosen && !carries {
        return Vec::new();
    }
    let row = |phase: &softlimb_motion::PlannedPhase| {
        let mut text = format!("  phase {:<16} {:6.2} s", phase.name, phase.move_us as f64 * 1e-6);
        if let Some(nearest) = phase.nearest {
            let name = &scene.obstacles()[nearest.obstacle].name.value;
            text.push_str(&format!(", at least {:.1} mm from `{name}`", nearest.distance_m * 1e3));
        }
        if let Some(tilt_rad) = phase.tilt_rad.filter(|tilt_rad| *tilt_rad > 0.0) {
            text.push_str(&format!(", object tilts by at most {:.1} deg", tilt_rad.to_degrees()));
        }
        match phase.via_points {
            0 => {}
            1 => text.push_str(", by 1 via point"),
            count => text.push_str(&format!(", by {count} via points")),
        }
        text
    };
    plan.phases.iter().map(row).collect()
}
