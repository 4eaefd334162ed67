//! `softlimb check`: the scene, and the reach of its limb.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::check_margins::{self, PrintedMargins};
use super::shared::{limb, show};
use super::{Failure, Outcome};
use softlimb_chart::labelled;
use softlimb_limb::Limb;
use softlimb_limb::fabricate::{Settings, advice};
use softlimb_motion as motion;
use softlimb_motion::{AirDemand, Margins, ModuleInverse, Plan};
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
        let plan = motion::plan(&scene, &limb)?;
        let inverses = motion::inverses(&scene, &limb)?;
        let sent = motion::sent(&scene, &limb, &plan)?;
        motion::check_goals(&scene, &limb, &plan, &sent, &inverses)?;
        let highest = sent.highest_pa(&limb);
        let margins = motion::margins(&scene, &limb, &plan, &sent)?;
        let too_small = check_margins::warnings(&scene, &limb, &plan, &margins);
        let made = advice(&scene, &Settings::default());
        let valves = motion::valve_warnings(&scene, &limb);
        let gripper = plan.gripper_warnings(scene.gripper_time_s());
        let warnings = [
            plan.warnings.clone(),
            scene.winding_warnings(),
            limb.restraint_warnings(),
            limb.stretch_warnings(&scene, &highest),
            too_small,
            made,
            valves,
            gripper,
        ]
        .concat();
        let air = motion::air_demand(&scene, &limb, &sent);
        let known = Known {
            scene: &scene,
            limb: &limb,
            plan: &plan,
            highest: &highest,
            inverses: &inverses,
            margins: &margins,
            air,
        };
        show(self.json, &known.printed(&warnings), || known.table())?;
        Ok(super::warn(&warnings))
    }
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    weightless: bool,
    channels: usize,
    rest_length_m: f64,
    mass_kg: f64,
    duration_s: f64,
    /// Air of one run at 100 kPa and 20 degC, m3, and the lowest supply, Pa gauge.
    air_m3: f64,
    supply_lowest_pa: f64,
    modules: Vec<PrintedModule<'a>>,
    phases: Vec<PrintedPhase<'a>>,
    weight: Option<PrintedWeight>,
    warnings: &'a [String],
}

#[derive(Serialize)]
struct PrintedModule<'a> {
    name: &'a str,
    highest_pressure_pa: f64,
    pressure_max_pa: f64,
    tables: bool,
    inverse_error: Option<f64>,
    no_tables_because: Option<String>,
}

#[derive(Serialize)]
struct PrintedPhase<'a> {
    name: &'a str,
    start_s: f64,
    move_s: f64,
    hold_s: f64,
    via_points: usize,
    clearance_m: Option<f64>,
    nearest_obstacle: Option<&'a str>,
    /// Largest tilt of a carried object since its grasp, rad.
    tilt_rad: Option<f64>,
    /// Absent of a weightless limb.
    #[serde(flatten)]
    margins: Option<PrintedMargins<'a>>,
}

/// The model that corrects for weight, and its error over the length.
#[derive(Serialize)]
struct PrintedWeight {
    model: &'static str,
    error: f64,
}

/// Findings of a check.
#[derive(Clone, Copy)]
struct Known<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    plan: &'a Plan,
    /// Highest gauge pressure of each module, Pa.
    highest: &'a [f64],
    inverses: &'a [ModuleInverse],
    /// One a phase, or none of a weightless limb.
    margins: &'a [Margins],
    air: AirDemand,
}

impl<'a> Known<'a> {
    fn printed(self, warnings: &'a [String]) -> Printed<'a> {
        let Self { scene, limb, plan, highest, inverses, margins, air } = self;
        let modules =
            limb.modules().iter().zip(highest).zip(inverses).map(|((module, pressure), inverse)| PrintedModule {
                name: &module.name,
                highest_pressure_pa: *pressure,
                pressure_max_pa: module.pressure_max_pa,
                tables: inverse.tables().is_some(),
                inverse_error: inverse.error(),
                no_tables_because: inverse.reason().map(|reason| reason.to_string()),
            });
        let phases = plan.phases.iter().enumerate().map(|(index, phase)| PrintedPhase {
            name: &phase.name,
            start_s: phase.start_us as f64 * 1e-6,
            move_s: phase.move_us as f64 * 1e-6,
            hold_s: phase.hold_us as f64 * 1e-6,
            via_points: phase.via_points,
            clearance_m: phase.nearest.map(|nearest| nearest.distance_m),
            nearest_obstacle: phase.nearest.map(|nearest| scene.obstacles()[nearest.obstacle].name.value.as_str()),
            tilt_rad: phase.tilt_rad,
            margins: margins.get(index).map(|margins| PrintedMargins::new(limb, margins)),
        });
        Printed {
            scene: scene.name(),
            weightless: scene.weightless(),
            channels: scene.channels(),
            rest_length_m: scene.rest_length_m(),
            mass_kg: scene.mass_kg(),
            duration_s: plan.duration_us() as f64 * 1e-6,
            air_m3: air.volume_m3,
            supply_lowest_pa: air.supply_min_pa,
            modules: modules.collect(),
            phases: phases.collect(),
            weight: plan.weighed().map(|weighed| PrintedWeight { model: weighed.tier.name(), error: weighed.error }),
            warnings,
        }
    }

    fn table(self) -> String {
        let Self { scene, limb, plan, highest, inverses, margins, air } = self;
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
            .chain([air])
            .chain(weight)
            .chain(phase_rows(scene, plan))
            .chain(check_margins::rows(plan, margins))
            .collect::<Vec<_>>()
            .join("\n")
    }
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
