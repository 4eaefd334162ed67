//! The mass on the tip, from where the tip was seen.

use std::fmt::Write;
use std::path::Path;

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::Payload;
use crate::cli::kept::read;
use crate::cli::{Failure, Outcome, note, say};
use softlimb_limb::Limb;
use softlimb_limb::statics::GRAVITY_M_PER_S2;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_rig::payload_estimation::{Mass, Observation, mass};
use softlimb_scene as scene;

pub(super) fn run(command: &Payload, file: &Path, table: &Path) -> Result<Outcome, Failure> {
    let percent = command.stiffness_error;
    if !(0.0..=50.0).contains(&percent) {
        return Err(Failure::wrong_line(format!("--stiffness-error = {percent} is not allowed: 0 to 50 %")));
    }
    let scene = scene::load(file)?;
    let limb = Limb::new(&scene)?;
    let plan = motion::sent(&scene, &limb, &motion::plan(&scene, &limb)?)?;
    let about = |error: &dyn std::fmt::Display| Failure::new(format!("{}: {error}", table.display()));
    let seen = Observation::read(&read(table)?, &limb, &plan).map_err(|error| about(&error))?;
    let found = mass(&scene, &limb, &plan, &seen, 1e-2 * percent).map_err(|error| about(&error))?;
    if command.json {
        say(&json(scene.name(), &found, &seen, &plan).to_string())?;
    } else {
        say(&text(scene.name(), &found, &seen, &plan, percent))?;
    }
    if found.interval_kg[0] <= 0.0 {
        note("warning: the interval reaches zero: what was seen with the load is not told from what was seen without");
        return Ok(Outcome::DoneWithWarnings);
    }
    Ok(Outcome::Done)
}

/// Writing to a string cannot fail.
fn text(name: &str, found: &Mass, seen: &[Observation], plan: &Plan, percent: f64) -> String {
    let [low, high] = found.interval_kg;
    let mut text =
        format!("{name}: the mass on the tip, by {} sightings in {} phases\n\n", seen.len(), found.displacements.len());
    let _ = writeln!(
        text,
        "mass {:.4} kg, weight {:.3} N; 95 %: {low:.4} to {high:.4} kg",
        found.kg,
        found.kg * GRAVITY_M_PER_S2
    );
    let _ = writeln!(
        text,
        "  {:.4} kg by how much the phases disagree ({:.3} mm a coordinate, {} degrees of freedom)",
        found.scatter_kg,
        1e3 * found.left_m,
        found.freedom
    );
    let _ = writeln!(text, "  {:.4} kg by a stiffness that is known to {percent} %", found.stiffness_kg);
    let _ = writeln!(text, "\n{:16} {:>26} {:>26}", "phase", "way of the tip x, y, z, mm", "by the model, mm");
    for way in &found.displacements {
        let _ = writeln!(
            text,
            "{:16} {:>26} {:>26}",
            plan.phases[way.phase].name,
            cells(&way.observed_m),
            cells(&way.modelled_m)
        );
    }
    let _ = writeln!(text, "\n{:>4} {:16} {:8} {:>26}", "line", "phase", "load", "left over x, y, z, mm");
    for (one, left) in seen.iter().zip(&found.residuals_m) {
        let _ =
            writeln!(text, "{:>4} {:16} {:8} {:>26}", one.line, plan.phases[one.phase].name, load(one), cells(left));
    }
    let _ = writeln!(text, "\nin the phases that carry it: payload = \"{:.4} kg\"", found.kg.max(0.0));
    text
}

fn load(one: &Observation) -> &'static str {
    if one.loaded { "unknown" } else { "none" }
}

fn cells(way_m: &Vector3<f64>) -> String {
    format!("{:.3}, {:.3}, {:.3}", 1e3 * way_m.x, 1e3 * way_m.y, 1e3 * way_m.z)
}

fn json(name: &str, found: &Mass, seen: &[Observation], plan: &Plan) -> Value {
    let ways = found.displacements.iter().map(|way| {
        json!({
            "phase": plan.phases[way.phase].name,
            "seen_m": way.observed_m.as_slice(),
            "modelled_m": way.modelled_m.as_slice(),
        })
    });
    let rows = seen.iter().zip(&found.residuals_m).map(|(one, left)| {
        json!({"line": one.line, "phase": plan.phases[one.phase].name, "load": load(one), "residual_m": left.as_slice()})
    });
    json!({
        "scene": name,
        "mass_kg": found.kg,
        "weight_n": found.kg * GRAVITY_M_PER_S2,
        "interval_kg": found.interval_kg,
        "scatter_kg": found.scatter_kg,
        "stiffness_kg": found.stiffness_kg,
        "degrees_of_freedom": found.freedom,
        "left_m": found.left_m,
        "phases": ways.collect::<Vec<_>>(),
        "rows": rows.collect::<Vec<_>>(),
    })
}
