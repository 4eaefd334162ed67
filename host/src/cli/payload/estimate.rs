//! `softlimb payload estimate`: the mass on the tip, from measured tip positions.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use nalgebra::Vector3;
use serde::Serialize;

use crate::cli::shared::{about, limb, quantity, read, show_of};
use crate::cli::{Failure, Outcome, note};
use softlimb_limb::statics::GRAVITY_M_PER_S2;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_rig::payload_estimation::{Mass, Observation, mass};
use softlimb_scene::Quantity;

/// Estimate the mass on the tip from tip positions measured without and with it
#[derive(Args)]
#[command(after_help = "Format of the data: docs/guide/estimate-a-payload.md\n\n\
                        Example: softlimb payload estimate scenes/loaded/carry-hanging.toml --data tips.csv")]
pub(super) struct Estimate {
    /// The scene file
    scene: PathBuf,
    /// Tip positions at the ends of the phases, without and with the load, a CSV file
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// Relative error of the limb's stiffness, 0 to 50 %, that the interval of the estimate covers
    #[arg(long, value_name = "PERCENT", default_value = "10 %", value_parser = quantity("%", 0.0, 50.0))]
    stiffness_error: Quantity,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Estimate {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        scene.require_no_segments("`payload estimate`")?;
        limb.require_plane_benders(&scene, "`payload estimate`")?;
        let plan = motion::plan(&scene, &limb)?;
        let plan = motion::sent(&scene, &limb, &plan)?.averaged(&limb, &plan);
        let about = about(&self.data);
        let seen = Observation::read(&read(&self.data)?, &limb, &plan).map_err(|error| about(&error))?;
        let found = mass(&scene, &limb, &plan, &seen, self.stiffness_error.si()).map_err(|error| about(&error))?;
        let percent = 100.0 * self.stiffness_error.si();
        show_of(self.json, &limb, &printed(scene.name(), &found, &seen, &plan), || {
            text(scene.name(), &found, &seen, &plan, percent)
        })?;
        if found.interval_kg[0] <= 0.0 {
            note("warning: the interval reaches zero: the data do not show whether there is a load");
            return Ok(Outcome::DoneWithWarnings);
        }
        Ok(Outcome::Done)
    }
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

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    mass_kg: f64,
    weight_n: f64,
    interval_kg: [f64; 2],
    scatter_kg: f64,
    stiffness_kg: f64,
    degrees_of_freedom: usize,
    left_m: f64,
    phases: Vec<Displacement<'a>>,
    rows: Vec<Row<'a>>,
}

/// Displacement of the tip by the load at the end of a phase, m.
#[derive(Serialize)]
struct Displacement<'a> {
    phase: &'a str,
    seen_m: [f64; 3],
    modelled_m: [f64; 3],
}

/// A row of the data and its residual.
#[derive(Serialize)]
struct Row<'a> {
    line: usize,
    phase: &'a str,
    load: &'static str,
    residual_m: [f64; 3],
}

fn printed<'a>(scene: &'a str, found: &Mass, seen: &[Observation], plan: &'a Plan) -> Printed<'a> {
    let phase = |index: usize| plan.phases[index].name.as_str();
    let displacements = found.displacements.iter().map(|way| Displacement {
        phase: phase(way.phase),
        seen_m: way.observed_m.into(),
        modelled_m: way.modelled_m.into(),
    });
    let rows = seen.iter().zip(&found.residuals_m).map(|(one, left)| Row {
        line: one.line,
        phase: phase(one.phase),
        load: load(one),
        residual_m: (*left).into(),
    });
    Printed {
        scene,
        mass_kg: found.kg,
        weight_n: found.kg * GRAVITY_M_PER_S2,
        interval_kg: found.interval_kg,
        scatter_kg: found.scatter_kg,
        stiffness_kg: found.stiffness_kg,
        degrees_of_freedom: found.freedom,
        left_m: found.left_m,
        phases: displacements.collect(),
        rows: rows.collect(),
    }
}
