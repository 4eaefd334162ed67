//! `softlimb check`: is this scene sound, and can the limb do what it asks?

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{Failure, Outcome};
use crate::design::Limb;
use crate::motion::{self, ModuleInverse, Plan};
use crate::scene::{self, Scene};

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
        let scene = scene::load(&self.scene)?;
        let limb = Limb::new(&scene)?;
        let plan = motion::plan(&scene, &limb)?;
        let inverses = motion::inverses(&scene, &limb)?;
        motion::check_goals(&scene, &limb, &plan, &inverses)?;
        let highest = highest_pressures(&plan);
        if self.json {
            super::say(&report(&scene, &limb, &plan, &highest, &inverses).to_string())?;
        } else {
            super::say(&table(&scene, &limb, &plan, &highest, &inverses))?;
        }
        Ok(Outcome::Done)
    }
}

/// Highest gauge pressure of each module over the plan, Pa.
fn highest_pressures(plan: &Plan) -> Vec<f64> {
    let knots = 0..plan.knots().len() as u64;
    let rows = knots.map(|knot| plan.states_at((knot * plan.knot_period_us) as f64));
    rows.fold(Vec::new(), |highest, row| {
        if highest.is_empty() {
            return row.iter().map(|state| state.pressure_pa).collect();
        }
        highest.iter().zip(&row).map(|(a, state): (&f64, _)| a.max(state.pressure_pa)).collect()
    })
}

fn report(scene: &Scene, limb: &Limb, plan: &Plan, highest: &[f64], inverses: &[ModuleInverse]) -> serde_json::Value {
    let modules: Vec<_> = limb
        .modules()
        .iter()
        .zip(highest)
        .zip(inverses)
        .map(|((module, pressure), inverse)| {
            json!({
                "name": module.name,
                "highest_pressure_pa": pressure,
                "pressure_max_pa": module.pressure_max_pa,
                "tables": inverse.tables().is_some(),
                "inverse_error": inverse.error(),
                "no_tables_because": inverse.reason().map(|reason| reason.to_string()),
            })
        })
        .collect();
    json!({
        "scene": scene.name(),
        "channels": scene.channels(),
        "rest_length_m": scene.rest_length_m(),
        "mass_kg": scene.mass_kg(),
        "duration_s": plan.duration_us() as f64 * 1e-6,
        "modules": modules,
    })
}

fn table(scene: &Scene, limb: &Limb, plan: &Plan, highest: &[f64], inverses: &[ModuleInverse]) -> String {
    let heading = format!(
        "{}: {} modules, {} channels, {:.3} m at rest, {:.2} kg, {} phases in {:.1} s",
        scene.name(),
        limb.modules().len(),
        scene.channels(),
        scene.rest_length_m(),
        scene.mass_kg(),
        plan.phases.len(),
        plan.duration_us() as f64 * 1e-6,
    );
    let modules = limb.modules().iter().zip(highest).zip(inverses).map(|((module, pressure), inverse)| {
        let (highest_kpa, allowed_kpa) = (pressure * 1e-3, module.pressure_max_pa * 1e-3);
        format!("  {:<16} up to {highest_kpa:6.2} kPa of {allowed_kpa:6.2} kPa, by {inverse}", module.name)
    });
    std::iter::once(heading).chain(modules).collect::<Vec<_>>().join("\n")
}
